#include "experiments/sweep/sweep.hpp"

#include "devices/passport/sealed_file.hpp"
#include "experiments/sweep/journal.hpp"
#include "experiments/worker_pool.hpp"
#include "loop/core/sha256.hpp"
#include "loop/runtime/interrupt_scope.hpp"
#include "record/sweep_file.hpp"

#include <algorithm>
#include <filesystem>
#include <map>
#include <unistd.h>
#include <utility>

namespace wholehand {
namespace fs = std::filesystem;
namespace {

constexpr std::size_t kMostRefusals = 5;

/// Digest of everything that the results depend on: the grid, the files that it reads, and the
/// program.
Expected<std::string> digestOf(const SweepGrid& grid, const SweepPlan& plan) {
  std::string all = plan.git_version + "\n" + grid.text;
  for (const std::string& file : filesOf(grid, plan.find)) {
    auto text = readWhole(file);
    if (!text) return text.errors();
    all += "\n" + fs::path(file).filename().string() + "\n" + *text;
  }
  return sha256(all);
}

class Sweep {
 public:
  Sweep(const SweepGrid& grid, const SweepPlan& plan, SweepJournal journal)
      : grid_(grid), plan_(plan), journal_(std::move(journal)) {}

  SweepOutcome run() {
    SweepOutcome outcome;
    outcome.cells = grid_.cells();
    const std::vector<int> missing = missingCells();
    outcome.finished = outcome.cells - static_cast<int>(missingOf(SweepShare{}).size());
    const auto work = [&](int job) { return runOne(missing[static_cast<std::size_t>(job)]); };
    const auto done = [&](int job, const std::string& line) {
      note(missing[static_cast<std::size_t>(job)], line, outcome);
    };
    const bool complete = workInProcesses(static_cast<int>(missing.size()), plan_.processes, work,
                                          done, InterruptScope::interrupted);
    outcome.interrupted = InterruptScope::interrupted();
    outcome.died = !complete && !outcome.interrupted;
    return outcome;
  }

  /// Writes the result file when every cell is finished. @return true when it was written
  Expected<bool> join(const std::string& digest) {
    const std::map<int, std::vector<double>> cells = journal_.finished();
    if (static_cast<int>(cells.size()) < grid_.cells()) return false;
    SweepFile file;
    file.trial = trialName(grid_.trial);
    file.digest = digest;
    file.git_version = plan_.git_version;
    file.grid = grid_.text;
    for (const SweepAxis& axis : grid_.axes) {
      file.axes.push_back({axis.name, axis.names, axis.numbers});
    }
    file.figures = figuresOf(grid_.trial);
    file.values.resize(file.figures.size());
    for (const auto& [cell, figures] : cells) {
      for (std::size_t i = 0; i < figures.size(); ++i) file.values[i].push_back(figures[i]);
    }
    if (auto written = writeSweepFile(file, plan_.out); !written) return written.errors();
    journal_.remove();
    return true;
  }

 private:
  [[nodiscard]] std::vector<int> missingOf(const SweepShare& share) const {
    const auto finished = journal_.finished();
    std::vector<int> missing;
    for (int cell = share.first; cell < grid_.cells(); cell += share.step) {
      if (finished.count(cell) == 0) missing.push_back(cell);
    }
    return missing;
  }
  [[nodiscard]] std::vector<int> missingCells() const {
    return missingOf(plan_.share.value_or(SweepShare{}));
  }

  // Runs one cell in a worker. Returns an empty text, or the reason why the cell was not finished.
  std::string runOne(int cell) {
    const std::string scratch = plan_.out + ".cells/scenes-" + std::to_string(::getpid());
    std::error_code ignored;  // the writer reports a missing folder
    fs::create_directories(scratch, ignored);
    auto figures = runCell(grid_, cell, plan_.find, scratch);
    if (!figures) return oneLine(figures.errors());
    if (auto kept = journal_.append(cell, *figures); !kept) return oneLine(kept.errors());
    return {};
  }

  static std::string oneLine(const Diagnostics& errors) {
    std::string text = format(errors);
    std::replace(text.begin(), text.end(), '\n', ' ');
    return text;
  }

  void note(int cell, const std::string& line, SweepOutcome& outcome) const {
    if (line.empty()) {
      ++outcome.run;
      ++outcome.finished;
    } else {
      outcome.refused.push_back(cell);
      if (outcome.refusals.size() < kMostRefusals) {
        outcome.refusals.push_back({grid_.path, 0, grid_.describe(cell), "", line, ""});
      }
    }
    if (plan_.progress) plan_.progress(outcome.finished, outcome.cells);
  }

  const SweepGrid& grid_;
  const SweepPlan& plan_;
  SweepJournal journal_;
};

}  // namespace

Expected<SweepOutcome> runSweep(const SweepGrid& grid, const SweepPlan& plan) {
  auto digest = digestOf(grid, plan);
  if (!digest) return digest.errors();
  SweepOutcome done{grid.cells(), grid.cells(), 0, false, true, {}, {}, false};
  std::error_code ignored;
  if (fs::exists(plan.out, ignored)) {
    auto found = readSweepDigest(plan.out);
    if (!found) return found.errors();
    if (*found == *digest) return done;
    return fileFault(plan.out, "holds another grid's results, or another program's",
                     "name another --out, or remove the file");
  }
  auto journal = SweepJournal::open(plan.out + ".cells", *digest,
                                    static_cast<int>(figuresOf(grid.trial).size()), !plan.share);
  if (!journal) return journal.errors();
  Sweep sweep(grid, plan, std::move(*journal));
  SweepOutcome outcome = sweep.run();
  auto joined = sweep.join(*digest);
  if (!joined) return joined.errors();
  // Another program of the same sweep may have written the result file first.
  outcome.written = *joined || fs::exists(plan.out, ignored);
  if (outcome.written) outcome.finished = outcome.cells;
  return outcome;
}

std::vector<std::vector<double>> mapOf(const SweepGrid& grid, const SweepMap& map,
                                       const std::vector<double>& figure) {
  const auto rows = static_cast<std::size_t>(grid.axes.at(map.rows).size());
  const auto columns = static_cast<std::size_t>(grid.axes.at(map.columns).size());
  std::vector<std::vector<double>> sums(rows, std::vector<double>(columns, 0.0));
  for (int cell = 0; cell < grid.cells(); ++cell) {
    const std::vector<int> at = grid.places(cell);
    sums.at(at.at(map.rows)).at(at.at(map.columns)) += figure.at(cell);
  }
  const double each =
      static_cast<double>(grid.cells()) /
      (map.rows == map.columns ? static_cast<double>(rows) : static_cast<double>(rows * columns));
  for (auto& row : sums) {
    for (double& value : row) value /= each;
  }
  return sums;
}

}  // namespace wholehand
