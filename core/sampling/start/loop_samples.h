#pragma once

#include <cstdint>
#include <vector>

#include "core/base/interrupt.h"
#include "core/density/density.h"
#include "core/sampling/start/plan.h"
#include "core/surface/surface.h"

namespace ccst::internal {

/// Fills `plan->start`, `rate`, `length` and `hole_capacity` from its half-edges.
void MeasureLoop(const Surface& surface, const Density& density, LoopPlan* plan);

/// Point of a loop at arc length `arc`.
SurfacePoint PointAt(const Surface& surface, const LoopPlan& loop, double arc);

/// Arc lengths of the loop's corners, increasing: vertices at which it turns by more than 60
/// degrees between the chords to half a spacing before and after, so that the zigzag of a scan's
/// rim is none. Of several nearer than 3/4 of a spacing the sharpest counts. Ends of creases always
/// do. Unfinished when `interrupt` was requested. Cost O(v log v) for v vertices.
/// @param is_corner  per vertex of the surface: the end of a crease.
/// @param side       wanted distance of the samples [arc length], > 0.
std::vector<double> FindCorners(const Surface& surface, const LoopPlan& loop,
                                const std::vector<std::uint8_t>& is_corner, double side,
                                Interrupt* interrupt);

/// More samples than any request may ask for: where counts of samples stop growing, so that
/// neither they nor their sums overflow on the thinnest of surfaces.
inline constexpr std::int64_t kCountCap = 1'000'000'000'000;

/// How many samples PlaceOnLoop() would place, at most kCountCap. Cost O(corners).
std::int64_t CountOnLoop(const LoopPlan& loop, const std::vector<double>& corners, double side);

/// Spreads about length / side samples over the loop, evenly between corners: CountOnLoop() of
/// them, which the caller has compared with what it may have.
/// @param offset  in [0, 1): where the first one lies on a loop without corners, in spacings.
void PlaceOnLoop(const std::vector<double>& corners, double side, double offset, LoopPlan* loop);

/// Into how many pieces samples divide a crease: about `side` long, shorter where it is bent. Once
/// there are more than `limit`, some number over it, at most kCountCap: too many to be placed.
/// Anything when `interrupt` was requested. Cost O(v + min(pieces, limit)).
/// @param least  >= 1: no fewer than these.
std::int64_t PiecesOf(const Surface& surface, const LoopPlan& crease, double side,
                      std::int64_t least, std::int64_t limit, Interrupt* interrupt);

/// What is known of the ends of creases.
struct CornerSet {
  std::vector<std::uint8_t> is_corner;   ///< Per vertex of the surface.
  std::vector<std::uint8_t> has_sample;  ///< Per vertex of the surface, or empty.
};

/// Spreads samples over a crease between two corners, `pieces` apart; the corners get one where
/// they have none yet.
void PlaceOnCrease(const Surface& surface, std::int64_t pieces, CornerSet* corners,
                   LoopPlan* crease);

}  // namespace ccst::internal
