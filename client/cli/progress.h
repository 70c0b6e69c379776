#pragma once

#include <cstdio>
#include <string>

#include "client/cli/flags.h"
#include "client/lib/client.h"
#include "core/sampling/run_control.h"

namespace ccst::cli {

/// One line for people, without a line end.
std::string ProgressLine(const AlternationReport& report);

/// A bar of about `width` columns with the figures beside it, without a line end. It fills as the
/// alternations approach their limit, which a run that converges does not reach.
std::string ProgressBar(const AlternationReport& report, int width);

/// One JSON object: iteration, energy, capacity_cv, flips, relocations, elapsed.
std::string ProgressJson(const AlternationReport& report);

/// Shows a run on `out` as it goes on.
class ProgressPrinter {
 public:
  /// kAuto becomes a bar when `out` is a terminal, else lines.
  ProgressPrinter(ProgressStyle style, std::FILE* out);

  void Show(const AlternationReport& report);
  /// Something that happens before or between alternations: in the queue, reading. Shown without
  /// control characters.
  void Note(const std::string& note);
  /// Ends a bar's line, so that other text can follow. Called before anything else is printed.
  void Finish();

  /// Whether people read `out` (neither kJson nor kNone).
  bool is_for_people() const {
    return style_ == ProgressStyle::kBar || style_ == ProgressStyle::kLines;
  }

 private:
  ProgressStyle style_;
  std::FILE* out_;
  bool line_is_open_ = false;
};

/// Callbacks that show alternations, places in the queue and uploads on `printer`, which must
/// outlive them.
SampleCallbacks CallbacksThatShow(ProgressPrinter& printer);

}  // namespace ccst::cli
