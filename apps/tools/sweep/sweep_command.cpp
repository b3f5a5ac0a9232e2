#include "apps/tools/sweep/sweep_command.hpp"

#include "apps/wholehand/shared/exit_code.hpp"
#include "apps/wholehand/shared/result_files.hpp"
#include "apps/wholehand/shared/sweep_files.hpp"
#include "experiments/sweep/sweep.hpp"
#include "files/text/text_file.hpp"
#include "loop/core/printable.hpp"
#include "loop/runtime/interrupt_scope.hpp"
#include "record/sweep_file.hpp"
#include "rig/program_version.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <optional>
#include <thread>
#include <unistd.h>

namespace wholehand {
namespace {

using Clock = std::chrono::steady_clock;

Expected<SweepShare> shareOfArray() {
  const auto id = environmentNumber("SLURM_ARRAY_TASK_ID");
  const auto count = environmentNumber("SLURM_ARRAY_TASK_COUNT");
  const auto least = environmentNumber("SLURM_ARRAY_TASK_MIN");
  const auto step = environmentNumber("SLURM_ARRAY_TASK_STEP");
  if (!id || !count || *count < 1 || !least || *id < *least) {
    return keyFault("", "--array", "", "finds no job array of Slurm",
                    "submit it with `sbatch --array=0-9`, or give each its --share K/N");
  }
  const int place = (*id - *least) / std::max(1, step.value_or(1));
  return SweepShare{place % *count, *count};
}

Expected<SweepShare> shareOfText(const std::string& text) {
  SweepShare share;
  int used = 0;
  const bool read = std::sscanf(text.c_str(), "%d/%d%n", &share.first, &share.step, &used) == 2 &&
                    static_cast<std::size_t>(used) == text.size();
  if (!read || share.step < 1 || share.first < 1 || share.first > share.step) {
    return Diagnostic{"", 0, "--share", text, "is no share", "1/4 is the first of four"};
  }
  --share.first;
  return share;
}

Expected<std::optional<SweepShare>> shareAsked(const SweepOptions& options) {
  if (!options.share.empty()) {
    auto share = shareOfText(options.share);
    if (!share) return share.errors();
    return std::optional(*share);
  }
  if (options.array) {
    auto share = shareOfArray();
    if (!share) return share.errors();
    return std::optional(*share);
  }
  return shareOfRank();
}

/// Duration as text: "1 min 20 s".
std::string duration(double seconds) {
  const int s = static_cast<int>(std::lround(seconds));
  if (s < 60) return fmt::format("{} s", s);
  if (s < 3600) return fmt::format("{} min {} s", s / 60, s % 60);
  return fmt::format("{} h {} min", s / 3600, s / 60 % 60);
}

/// Progress: one line that is rewritten on a terminal, else a line every five seconds.
class Progress {
 public:
  void operator()(int finished, int all) {
    const auto now = Clock::now();
    if (first_ < 0) first_ = finished - 1;
    const std::chrono::duration<double> spent = now - began_, since = now - reported_;
    if (since.count() < (terminal_ ? 0.2 : 5.0) && finished < all) return;
    reported_ = now;
    const double each_s = spent.count() / std::max(1, finished - first_);
    const std::string text = fmt::format("{} of {} cells, about {} left", finished, all,
                                         duration(each_s * (all - finished)));
    std::fprintf(stderr, terminal_ ? "\r%s\033[K" : "%s\n", text.c_str());
    drawn_ = terminal_;
  }
  ~Progress() {
    if (drawn_) std::fprintf(stderr, "\n");
  }

 private:
  const bool terminal_ = ::isatty(STDERR_FILENO) != 0;
  const Clock::time_point began_ = Clock::now();
  Clock::time_point reported_ = {};
  int first_ = -1;
  bool drawn_ = false;
};

struct FilledMap {
  const SweepMap* map;
  std::vector<std::vector<double>> values;
};

Expected<std::vector<FilledMap>> fillMaps(const SweepGrid& grid, const std::string& out) {
  std::vector<FilledMap> filled;
  for (const SweepMap& map : grid.maps) {
    auto values = readSweepValues(out, {map.figure});
    if (!values) return values.errors();
    filled.push_back({&map, mapOf(grid, map, values->front())});
  }
  return filled;
}

void print(const SweepGrid& grid, const FilledMap& filled) {
  const SweepAxis& rows = grid.axes.at(filled.map->rows);
  const SweepAxis& columns = grid.axes.at(filled.map->columns);
  const auto label = [](const SweepAxis& axis, int i) { return printable(axis.label(i)); };
  std::size_t width = rows.name.size();
  for (int r = 0; r < rows.size(); ++r) width = std::max(width, label(rows, r).size());
  std::printf("\n%s, mean over all else; columns: %s\n%-*s", filled.map->figure.c_str(),
              columns.name.c_str(), static_cast<int>(width), rows.name.c_str());
  for (int c = 0; c < columns.size(); ++c) std::printf(" %9.9s", label(columns, c).c_str());
  std::printf("\n");
  for (int r = 0; r < rows.size(); ++r) {
    std::printf("%-*s", static_cast<int>(width), label(rows, r).c_str());
    for (int c = 0; c < columns.size(); ++c) std::printf(" %9.3g", filled.values[r][c]);
    std::printf("\n");
  }
}

ChartTable tableOf(const SweepGrid& grid, const FilledMap& filled) {
  const SweepAxis& rows = grid.axes.at(filled.map->rows);
  const SweepAxis& columns = grid.axes.at(filled.map->columns);
  ChartTable table;
  table.title = filled.map->figure;
  table.heads = {rows.name + " \\ " + columns.name};
  for (int c = 0; c < columns.size(); ++c) table.heads.emplace_back(columns.label(c));
  for (int r = 0; r < rows.size(); ++r) {
    std::vector<PageText> row{rows.label(r)};
    for (const double value : filled.values[r]) row.emplace_back(fmt::format("{:.3g}", value));
    table.rows.push_back(std::move(row));
  }
  return table;
}

/// Values that span a larger factor are drawn on a logarithmic scale.
constexpr double kMostLinear = 20.0;

/// True when every value is a share of cells.
bool isShare(const FilledMap& filled) {
  for (const auto& row : filled.values) {
    for (const double value : row) {
      if (value < 0.0 || value > 1.0) return false;
    }
  }
  return filled.map->figure.find('_') == std::string::npos;  // without a unit
}

/// Chart with a line for each row over the columns, if these are increasing numbers; else empty.
std::optional<Chart> chartOf(const SweepGrid& grid, const FilledMap& filled) {
  constexpr std::array kColors{"--ax-x", "--ax-y", "--ax-z", "--ax-f", "--ax-c", "--ax-t"};
  const SweepAxis& rows = grid.axes.at(filled.map->rows);
  const SweepAxis& columns = grid.axes.at(filled.map->columns);
  if (columns.numbers.size() < 2 ||
      !std::is_sorted(columns.numbers.begin(), columns.numbers.end())) {
    return std::nullopt;
  }
  Chart chart;
  chart.title = filled.map->figure + ", " + columns.name + " →";
  chart.height_px = 220;
  const double first = columns.numbers.front(), last = columns.numbers.back();
  chart.x.logarithmic = first > 0.0 && last / first > kMostLinear;
  chart.x.from = first;
  chart.x.to = last;
  if (isShare(filled)) {
    chart.y.from = 0.0;
    chart.y.to = 1.05;
  }
  for (int r = 0; r < rows.size(); ++r) {
    ChartLine line{rows.name + " " + rows.label(r),
                   kColors.at(static_cast<std::size_t>(r) % kColors.size())};
    if (r >= static_cast<int>(kColors.size())) line.dash_px = {6, 3};
    for (int c = 0; c < columns.size(); ++c) {
      line.points.push_back({columns.numbers[c], filled.values[r][c]});
    }
    chart.lines.push_back(std::move(line));
  }
  return chart;
}

ChartPage pageOf(const SweepGrid& grid, const std::vector<FilledMap>& maps) {
  ChartPage page;
  page.title = grid.name;
  for (const FilledMap& filled : maps) {
    if (auto chart = chartOf(grid, filled)) page.charts.push_back(std::move(*chart));
    page.tables.push_back(tableOf(grid, filled));
  }
  return page;
}

void describe(const SweepGrid& grid, const std::optional<SweepShare>& share, int processes) {
  std::string who = fmt::format("{} process{}", processes, processes == 1 ? "" : "es");
  if (share) who += fmt::format(", share {} of {}", share->first + 1, share->step);
  std::printf("%s: %s; %s\n", grid.name.c_str(), summaryOf(grid).c_str(), who.c_str());
  std::fflush(stdout);
}

int printOutcome(const SweepGrid& grid, const SweepOptions& options, bool share,
                 const SweepOutcome& outcome) {
  const int left = outcome.cells - outcome.finished;
  if (!outcome.refusals.empty()) {
    refuse(outcome.refusals);
    std::fprintf(stderr, "wholehand: %zu cell%s could not be run\n", outcome.refused.size(),
                 plural(outcome.refused.size()));
    return kExitBadInput;
  }
  if (outcome.written) {
    auto maps = fillMaps(grid, options.out);
    if (!maps) return refuse(maps.errors());
    for (const FilledMap& filled : *maps) print(grid, filled);
    if (!options.chart.empty()) {
      if (auto done = writeCharts(pageOf(grid, *maps), options.chart); !done) {
        return refuse(done.errors());
      }
    }
    std::printf("\n%d cells, %d of them run now: %s\n", outcome.cells, outcome.run,
                printable(options.out).c_str());
    return kExitDone;
  }
  if (outcome.interrupted) {
    std::printf("\nInterrupted: %d cells are kept, %d are left. The same command goes on.\n",
                outcome.finished, left);
    return kExitInterrupted;
  }
  if (outcome.died) {
    std::fprintf(stderr,
                 "wholehand: a process that ran cells died; %d cells are kept, %d are left. The "
                 "same command goes on.\n",
                 outcome.finished, left);
    return kExitFault;
  }
  if (!share) {
    std::fprintf(stderr,
                 "wholehand: of %d cells what was kept is damaged. The same command runs them "
                 "again.\n",
                 left);
    return kExitFault;
  }
  std::printf("\nThis share is done; the last share to end writes %s\n",
              printable(options.out).c_str());
  return kExitDone;
}

}  // namespace

std::optional<int> environmentNumber(const char* name) {
  const char* const text = std::getenv(name);
  if (text == nullptr) return std::nullopt;
  char* end = nullptr;
  const long value = std::strtol(text, &end, 10);
  if (end == text || *end != '\0' || value < 0 || value > 1'000'000) return std::nullopt;
  return static_cast<int>(value);
}

#ifndef WHOLEHAND_LAB
std::optional<SweepShare> shareOfRank() {
  return std::nullopt;
}
#endif

int sweepCommand(const SweepOptions& options) {
  const InterruptScope interrupts;
  auto grid = loadSweepGrid(options.grid);
  if (!grid) return refuse(grid.errors());
  auto share = shareAsked(options);
  if (!share) return refuse(share.errors());
  if (!options.chart.empty()) {
    if (auto ready = prepareCharts(options.chart, {}); !ready) return refuse(ready.errors());
  }
  SweepPlan plan;
  plan.out = options.out;
  plan.git_version = programVersion();
  plan.share = *share;
  const int cores = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  plan.processes = options.processes > 0 ? options.processes : (plan.share ? 1 : cores);
  plan.find = filesBeside(options.grid);
  if (Diagnostics faults = faultsOfCells(*grid, plan.find); !faults.empty()) return refuse(faults);
  Progress progress;
  plan.progress = [&progress](int finished, int all) { progress(finished, all); };
  describe(*grid, plan.share, plan.processes);
  auto outcome = runSweep(*grid, plan);
  if (!outcome) return refuse(outcome.errors());
  return printOutcome(*grid, options, plan.share.has_value(), *outcome);
}

}  // namespace wholehand
