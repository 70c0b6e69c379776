#include "client/cli/progress.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include <nlohmann/json.hpp>
#include <sys/ioctl.h>
#include <unistd.h>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "core/base/printable_text.h"

namespace ccst::cli {
namespace {

constexpr int kDefaultColumns = 80;
constexpr int kMinBarWidth = 10;
constexpr int kMaxBarWidth = 32;
// A note is one line; some tell what a server said.
constexpr std::size_t kMaxNoteBytes = 1024;
constexpr char kClearLine[] = "\r\x1b[K";

int Columns(std::FILE* out) {
  winsize size = {};
  if (ioctl(fileno(out), TIOCGWINSZ, &size) != 0 || size.ws_col == 0) return kDefaultColumns;
  return size.ws_col;
}

std::string Figures(const AlternationReport& report) {
  return absl::StrFormat("energy %.3e  variation %.2f %%  %.1f s", report.energy,
                         100.0 * report.capacity_cv, report.elapsed_seconds);
}

}  // namespace

std::string ProgressLine(const AlternationReport& report) {
  return absl::StrFormat("alternation %3d  %s  flips %d  relocations %d", report.alternation,
                         Figures(report), report.flips, report.relocations);
}

std::string ProgressBar(const AlternationReport& report, int width) {
  const std::string figures = absl::StrFormat(" %3d of %d  %s", report.alternation,
                                              report.alternation_limit, Figures(report));
  const int cells =
      std::clamp(width - static_cast<int>(figures.size()) - 3, kMinBarWidth, kMaxBarWidth);
  const double share = report.alternation_limit > 0
                           ? static_cast<double>(report.alternation) / report.alternation_limit
                           : 1.0;
  const int full = static_cast<int>(std::lround(cells * std::clamp(share, 0.0, 1.0)));
  return absl::StrCat("[", std::string(full, '#'), std::string(cells - full, '.'), "]", figures);
}

std::string ProgressJson(const AlternationReport& report) {
  nlohmann::ordered_json json;
  json["iteration"] = report.alternation;
  json["energy"] = report.energy;
  json["capacity_cv"] = report.capacity_cv;
  json["flips"] = report.flips;
  json["relocations"] = report.relocations;
  json["elapsed"] = report.elapsed_seconds;
  return json.dump();
}

ProgressPrinter::ProgressPrinter(ProgressStyle style, std::FILE* out) : style_(style), out_(out) {
  if (style_ == ProgressStyle::kAuto) {
    style_ = isatty(fileno(out_)) == 1 ? ProgressStyle::kBar : ProgressStyle::kLines;
  }
}

void ProgressPrinter::Show(const AlternationReport& report) {
  switch (style_) {
    case ProgressStyle::kBar:
      std::fprintf(out_, "%s%s", kClearLine, ProgressBar(report, Columns(out_)).c_str());
      line_is_open_ = true;
      break;
    case ProgressStyle::kJson:
      std::fprintf(out_, "%s\n", ProgressJson(report).c_str());
      break;
    case ProgressStyle::kLines:
      std::fprintf(out_, "%s\n", ProgressLine(report).c_str());
      break;
    case ProgressStyle::kAuto:
    case ProgressStyle::kNone:
      return;
  }
  std::fflush(out_);
}

void ProgressPrinter::Note(const std::string& note) {
  const std::string text = PrintableExcerpt(note, kMaxNoteBytes);
  if (style_ == ProgressStyle::kBar) {
    std::fprintf(out_, "%s%s", kClearLine, text.c_str());
    line_is_open_ = true;
  } else if (style_ == ProgressStyle::kLines) {
    std::fprintf(out_, "%s\n", text.c_str());
  }
  std::fflush(out_);
}

SampleCallbacks CallbacksThatShow(ProgressPrinter& printer) {
  SampleCallbacks callbacks;
  callbacks.on_snapshot = [&printer](const v1::Job& snapshot) {
    if (snapshot.state() != v1::Job::STATE_QUEUED || snapshot.queue_position() == 0) return;
    printer.Note(absl::StrCat("waiting; jobs ahead: ", snapshot.queue_position()));
  };
  callbacks.on_progress = [&printer](const AlternationReport& report) { printer.Show(report); };
  callbacks.on_upload = [&printer, shown = std::int64_t{-1}](std::int64_t sent,
                                                             std::int64_t total) mutable {
    const std::int64_t tenths = 10 * sent / total;
    if (tenths == shown) return;
    shown = tenths;
    printer.Note(absl::StrFormat("uploading: %d %% of %.1f MiB", 10 * tenths,
                                 static_cast<double>(total) / (1 << 20)));
  };
  return callbacks;
}

void ProgressPrinter::Finish() {
  if (!line_is_open_) return;
  std::fputc('\n', out_);
  std::fflush(out_);
  line_is_open_ = false;
}

}  // namespace ccst::cli
