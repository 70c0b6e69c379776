#include "core/repair/orientation.h"

#include <cstddef>
#include <utility>

#include <Eigen/Geometry>

namespace ccst::repair {
namespace {

/// Whether the faces on both sides of a linked slot run the same way along it as they stand.
bool Opposed(const LinkedFaces& linked, std::int32_t slot) {
  return linked.Ascends(slot) == linked.Ascends(linked.links[slot]);
}

/// Whether they still do after the flips.
bool InConflict(const LinkedFaces& linked, const std::vector<std::uint8_t>& flips,
                std::int32_t slot) {
  const bool turned = flips[slot / 3] != flips[linked.links[slot] / 3];
  return Opposed(linked, slot) != turned;
}

/// A flip for every face. With `agreeing_first` neighbours that agree are visited before others,
/// so that where no orientation exists the contradictions come to lie on edges where the input
/// disagrees; without, faces are visited by their distance, which gives short lines of them.
std::vector<std::uint8_t> SpreadFlips(const LinkedFaces& linked, bool agreeing_first,
                                      Interrupt* interrupt) {
  std::vector<std::uint8_t> flips(linked.faces.size(), 0);
  std::vector<std::uint8_t> visited(linked.faces.size(), 0);
  std::vector<std::int32_t> stack;
  std::vector<std::pair<std::int32_t, bool>> later;
  for (std::int32_t seed = 0; seed < linked.count(); ++seed) {
    if (visited[seed]) continue;
    later.assign(1, {seed, false});
    for (std::size_t next = 0; next < later.size(); ++next) {
      if (visited[later[next].first]) continue;
      visited[later[next].first] = 1;
      flips[later[next].first] = later[next].second;
      stack.assign(1, later[next].first);
      while (!stack.empty()) {
        if (interrupt->RequestedAfter(1)) return flips;
        const std::int32_t f = stack.back();
        stack.pop_back();
        for (std::int32_t s = 3 * f; s < 3 * f + 3; ++s) {
          if (linked.links[s] < 0) continue;
          const std::int32_t g = linked.links[s] / 3;
          if (visited[g]) continue;
          const bool opposed = Opposed(linked, s);
          if (opposed || !agreeing_first) {
            later.emplace_back(g, static_cast<bool>(flips[f]) != opposed);
          } else {
            visited[g] = 1;
            flips[g] = flips[f];
            stack.push_back(g);
          }
        }
      }
    }
  }
  return flips;
}

/// Turns single faces while that leaves fewer contradictions: straightens the lines to cut.
void Straighten(const LinkedFaces& linked, Interrupt* interrupt, std::vector<std::uint8_t>* flips) {
  const auto gains = [&](std::int32_t f) {
    int balance = 0;
    for (std::int32_t s = 3 * f; s < 3 * f + 3; ++s) {
      if (linked.links[s] >= 0 && linked.links[s] / 3 != f) {
        balance += InConflict(linked, *flips, s) ? 1 : -1;
      }
    }
    return balance > 0;
  };
  std::vector<std::int32_t> work;
  for (std::int32_t f = linked.count() - 1; f >= 0; --f) {
    if (interrupt->RequestedAt(f)) return;
    if (gains(f)) work.push_back(f);
  }
  while (!work.empty() && !interrupt->RequestedAfter(1)) {
    const std::int32_t f = work.back();
    work.pop_back();
    if (!gains(f)) continue;
    (*flips)[f] ^= 1;
    for (std::int32_t s = 3 * f; s < 3 * f + 3; ++s) {
      if (linked.links[s] >= 0) work.push_back(linked.links[s] / 3);
    }
  }
}

std::int64_t CountConflicts(const LinkedFaces& linked, const std::vector<std::uint8_t>& flips) {
  std::int64_t count = 0;
  for (std::int32_t s = 0; s < 3 * linked.count(); ++s) {
    if (linked.links[s] > s) count += InConflict(linked, flips, s);
  }
  return count;
}

/// Flips with few contradictions; none if there can be none.
std::vector<std::uint8_t> ChooseFlips(const LinkedFaces& linked, Interrupt* interrupt) {
  std::vector<std::uint8_t> flips = SpreadFlips(linked, true, interrupt);
  if (interrupt->Requested() || CountConflicts(linked, flips) == 0) return flips;
  Straighten(linked, interrupt, &flips);
  std::vector<std::uint8_t> others = SpreadFlips(linked, false, interrupt);
  Straighten(linked, interrupt, &others);
  const bool shorter = CountConflicts(linked, others) < CountConflicts(linked, flips);
  return shorter ? others : flips;
}

/// Unfinished when `interrupt` was requested.
void FindPieces(const LinkedFaces& linked, Interrupt* interrupt, Orientation* orientation) {
  orientation->pieces.assign(linked.faces.size(), -1);
  orientation->piece_count = 0;
  std::vector<std::int32_t> stack;
  for (std::int32_t seed = 0; seed < linked.count(); ++seed) {
    if (orientation->pieces[seed] >= 0) continue;
    const std::int32_t piece = orientation->piece_count++;
    orientation->pieces[seed] = piece;
    stack.assign(1, seed);
    while (!stack.empty()) {
      if (interrupt->RequestedAfter(1)) return;
      const std::int32_t f = stack.back();
      stack.pop_back();
      for (std::int32_t s = 3 * f; s < 3 * f + 3; ++s) {
        const std::int32_t g = linked.links[s] < 0 ? -1 : linked.links[s] / 3;
        if (g < 0 || orientation->pieces[g] >= 0) continue;
        orientation->pieces[g] = piece;
        stack.push_back(g);
      }
    }
  }
}

/// Per piece: faces that stay less faces that turn.
std::vector<std::int64_t> Balance(const Orientation& orientation) {
  std::vector<std::int64_t> balance(orientation.piece_count, 0);
  for (std::size_t f = 0; f < orientation.flips.size(); ++f) {
    balance[orientation.pieces[f]] += orientation.flips[f] ? -1 : 1;
  }
  return balance;
}

/// Per piece whose balance is 0: whether the other orientation is the better one.
std::vector<std::uint8_t> BreakTies(const Geometry& geometry,
                                    const std::vector<std::int32_t>& positions_of,
                                    const LinkedFaces& linked, const Orientation& orientation,
                                    const std::vector<std::int64_t>& balance) {
  std::vector<std::uint8_t> turn(balance.size(), 0);
  std::vector<std::uint8_t> open(balance.size(), 0);
  std::vector<std::int32_t> first(balance.size(), -1);
  std::vector<double> volumes(balance.size(), 0.0);
  for (std::int32_t f = 0; f < linked.count(); ++f) {
    const std::int32_t piece = orientation.pieces[f];
    if (balance[piece] != 0) continue;
    if (first[piece] < 0) first[piece] = f;
    for (std::int32_t s = 3 * f; s < 3 * f + 3; ++s) open[piece] |= linked.links[s] < 0;
    const std::int32_t base = positions_of[linked.faces[first[piece]][0]];
    const Eigen::Vector3i face =
        linked.faces[f].unaryExpr([&](int fan) { return positions_of[fan]; });
    const double volume = geometry.Edge(base, face[0])
                              .cross(geometry.Edge(base, face[1]))
                              .dot(geometry.Edge(base, face[2]));
    volumes[piece] += orientation.flips[f] ? -volume : volume;
  }
  for (std::size_t piece = 0; piece < balance.size(); ++piece) {
    if (balance[piece] != 0) continue;
    const bool by_first = open[piece] || volumes[piece] == 0.0;
    turn[piece] = by_first ? orientation.flips[first[piece]] : volumes[piece] < 0.0;
  }
  return turn;
}

}  // namespace

Orientation OrientAlongLinks(LinkedFaces* linked, std::int64_t* cuts, Interrupt* interrupt) {
  Orientation orientation;
  orientation.flips = ChooseFlips(*linked, interrupt);
  *cuts = 0;
  if (interrupt->Requested()) return orientation;
  for (std::int32_t s = 0; s < 3 * linked->count(); ++s) {
    if (linked->links[s] < 0 || !InConflict(*linked, orientation.flips, s)) continue;
    linked->Unlink(s);
    ++*cuts;
  }
  FindPieces(*linked, interrupt, &orientation);
  if (interrupt->Requested()) return orientation;
  const std::vector<std::int64_t> balance = Balance(orientation);
  for (std::size_t f = 0; f < orientation.flips.size(); ++f) {
    if (balance[orientation.pieces[f]] < 0) orientation.flips[f] ^= 1;
  }
  return orientation;
}

std::int64_t ApplyOrientation(const Geometry& geometry,
                              const std::vector<std::int32_t>& positions_of,
                              Orientation* orientation, LinkedFaces* linked, Interrupt* interrupt) {
  FindPieces(*linked, interrupt, orientation);
  if (interrupt->Requested()) return 0;
  const std::vector<std::int64_t> balance = Balance(*orientation);
  const std::vector<std::uint8_t> turn =
      BreakTies(geometry, positions_of, *linked, *orientation, balance);
  std::int64_t flipped = 0;
  for (std::size_t f = 0; f < orientation->flips.size(); ++f) {
    const std::int32_t piece = orientation->pieces[f];
    if (balance[piece] < 0 || turn[piece]) orientation->flips[f] ^= 1;
    flipped += orientation->flips[f];
  }
  if (flipped == 0) return 0;
  // (a, b, c) becomes (a, c, b): the first and the last edge change places.
  std::vector<std::int32_t> moved(linked->links.size(), -1);
  const auto place = [&](std::int32_t s) {
    return orientation->flips[s / 3] ? 3 * (s / 3) + 2 - s % 3 : s;
  };
  for (std::int32_t s = 0; s < 3 * linked->count(); ++s) {
    if (linked->links[s] >= 0) moved[place(s)] = place(linked->links[s]);
  }
  linked->links = std::move(moved);
  for (std::int32_t f = 0; f < linked->count(); ++f) {
    if (!orientation->flips[f]) continue;
    std::swap(linked->faces[f][1], linked->faces[f][2]);
    std::swap(linked->source_corner[f][1], linked->source_corner[f][2]);
  }
  orientation->flips.assign(linked->faces.size(), 0);
  return flipped;
}

}  // namespace ccst::repair
