#include "report/report_page.hpp"

#include "core/escape_html.hpp"
#include "report/html_text.hpp"
#include "report/report_plots.hpp"
#include "report/report_style.hpp"
#include "report/svg_plot.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <filesystem>

namespace wholehand {
namespace {

std::string e(const std::string& text) {
  return escapeHtml(text);
}

std::string fileName(const std::string& path) {
  return std::filesystem::path(path).filename().string();
}

std::string roleWord(const ReportAxis& axis, int index) {
  const std::string word = axisPen(axis.name, index).word;
  if (axis.role == AxisRole::kArm) return "arm " + word;
  return axis.role == AxisRole::kWrist ? "wrist " + word : word;
}

// A limit as its file states it: 20, 7.5, 0.85.
std::string asStated(double value) {
  int decimals = 0;
  for (double scaled = value; decimals < 3 && std::abs(scaled - std::round(scaled)) > 1e-9;
       scaled = value * std::pow(10.0, decimals)) {
    ++decimals;
  }
  return formatNumber(value, decimals);
}

std::string figure(const std::string& number, const std::string& unit, const std::string& label) {
  return "<div><b>" + e(number) + (unit.empty() ? "" : " <small>" + e(unit) + "</small>") +
         "</b><span>" + e(label) + "</span></div>";
}

/// The largest effort among the axes of one role that are told in the same unit as the first.
std::string effortFigure(const ReportData& data, AxisRole role) {
  const ReportAxis* most = nullptr;
  int index = 0;
  for (std::size_t i = 0; i < data.axes.size(); ++i) {
    const ReportAxis& axis = data.axes[i];
    if (axis.role != role) continue;
    const bool better = most == nullptr || (axis.effort_unit == most->effort_unit
                                                ? axis.largest_effort > most->largest_effort
                                                : axis.effort_unit == "N");
    if (!better) continue;
    most = &axis;
    index = static_cast<int>(i);
  }
  if (most == nullptr) return {};
  const int decimals = most->effort_unit == "N" ? 1 : 2;
  return figure(formatNumber(most->largest_effort, decimals),
                most->effort_unit + ", limit " + asStated(most->effort_limit),
                "largest effort, " + roleWord(*most, index));
}

/// ", thumb_flexion", or ", most on thumb_flexion" where others had the fault, too; empty where it
/// has no axis.
std::string axisOf(const ReportData& data, std::size_t bit) {
  const auto& counts = data.summary.fault_axes[bit];
  const auto most = std::max_element(counts.begin(), counts.end());
  const auto axis = static_cast<std::size_t>(most - counts.begin());
  if (*most == 0 || axis >= data.axes.size()) return {};
  return (*most == data.summary.faults[bit] ? ", " : ", most on ") + data.axes[axis].name;
}

std::string faultFigure(const ReportData& data) {
  constexpr auto kLimitBit =
      static_cast<std::size_t>(std::countr_zero(static_cast<std::uint32_t>(Fault::kEffortLimit)));
  const TickSummary& s = data.summary;
  std::string label = "no limit reached";
  const std::uint64_t limited = s.faults[kLimitBit];
  if (limited > 0) {
    label = "limit reached in " + formatCount(limited) + (limited == 1 ? " tick" : " ticks") +
            axisOf(data, kLimitBit);
  }
  for (int bit = kFaultBits - 1; bit >= 0; --bit) {
    const auto at = static_cast<std::size_t>(bit);
    const bool stops = kFaultTable[at].reaction == FaultReaction::kStops;
    if (stops && s.faults[at] > 0) label = kFaultTable[at].name + axisOf(data, at);
  }
  return figure(formatCount(s.stopping_faults), s.stopping_faults == 1 ? "fault tick" : "faults",
                label);
}

std::string keyFigures(const ReportData& data) {
  const TickSummary& s = data.summary;
  const auto touched = std::count_if(data.bodies.begin(), data.bodies.end(),
                                     [](const BodyStory& b) { return !b.touches.empty(); });
  double way_m = 0.0;
  for (const BodyStory& b : data.bodies) way_m += b.travelled_m;
  std::string hand = effortFigure(data, AxisRole::kHand);
  if (hand.empty()) hand = effortFigure(data, AxisRole::kWrist);
  std::string arm = effortFigure(data, AxisRole::kArm);
  const std::string force =
      figure(formatNumber(data.largest_contact_force_n, 1), "N", "largest contact force in all");
  std::string out = "<section class=\"sum\">";
  out += figure(formatDuration(data.to_s - data.from_s), "", "length of the recording");
  out += hand.empty() ? force : hand;
  out += arm.empty() ? force : arm;
  out += data.bodies.empty() ? figure("0", "objects", "in the scene")
                             : figure(std::to_string(touched),
                                      "of " + std::to_string(data.bodies.size()) +
                                          (data.bodies.size() == 1 ? " object" : " objects"),
                                      "touched; moved " + formatNumber(way_m, 2) + " m in all");
  out += faultFigure(data);
  out +=
      figure(formatCount(s.missed_deadlines), "of " + formatCount(s.ticks),
             data.meta.simulated_clock ? "deadlines missed (simulated clock)" : "deadlines missed");
  return out + "</section>";
}

std::string header(const ReportData& data) {
  const RecordingMeta& m = data.meta;
  std::string device =
      std::to_string(m.axis_names.size()) + (m.axis_names.size() == 1 ? " axis" : " axes");
  if (const std::string name = embeddedName(m, "device"); !name.empty())
    device = name + ", " + device;
  device += m.simulated_device ? ", simulated" : ", held by a person";
  const auto item = [](const char* term, const std::string& value) {
    return std::string("<div><dt>") + term + "</dt><dd>" + e(value) + "</dd></div>";
  };
  return "<header><div><div class=\"k\">Wholehand recording report</div><h1>" +
         e(m.title.empty() ? fileName(data.path) : m.title) + "</h1></div><dl>" +
         item("Recorded", formatDate(m.created_utc)) +
         item("Length", formatDuration(data.to_s - data.from_s)) + item("Device", device) +
         (data.emergency_stop_s < 0.0
              ? ""
              : item("Emergency stop", "at " + formatNumber(data.emergency_stop_s, 2) + " s")) +
         (data.missing_ticks == 0
              ? ""
              : item("Missing",
                     formatCount(data.missing_ticks) + " ticks, " +
                         formatDuration(static_cast<double>(data.missing_ticks) * m.period_s))) +
         item("File", fileName(data.path)) + "</dl></header>";
}

std::string bodyTable(const ReportData& data) {
  constexpr std::size_t kMostRows = 8;
  std::vector<const BodyStory*> rows;
  for (const BodyStory& b : data.bodies) rows.push_back(&b);
  std::stable_sort(rows.begin(), rows.end(), [](const BodyStory* a, const BodyStory* b) {
    const auto first = [](const BodyStory* s) {
      return s->touches.empty() ? HUGE_VAL : s->touches.front().from_s;
    };
    return first(a) < first(b);
  });
  std::string out =
      "<h2>Objects <small>by first touch</small></h2><table><thead><tr><th>Object</th>"
      "<th>first<br>s</th><th>touches<br>&nbsp;</th><th>longest<br>s</th><th>held<br>s</th>"
      "<th>force<br>N</th><th>way<br>cm</th></tr></thead><tbody>";
  for (std::size_t i = 0; i < rows.size() && i < kMostRows; ++i) {
    const BodyStory& b = *rows[i];
    const bool touched = !b.touches.empty();
    const auto cell = [touched](double v, int decimals) {
      return "<td>" + (touched ? formatNumber(v, decimals) : std::string("–")) + "</td>";
    };
    out += "<tr><td>" + e(b.name) + "</td>" + cell(touched ? b.touches.front().from_s : 0.0, 1) +
           "<td>" + std::to_string(b.touches.size()) + "</td>" + cell(b.longest_s(), 2) +
           cell(b.held_s(), 1) + cell(b.largestForce_n(), 1) + "<td>" +
           formatNumber(b.travelled_m * 100.0, 1) + "</td></tr>";
  }
  out += "</tbody></table>";
  if (rows.size() > kMostRows) {
    out += "<p class=\"note\">and " + std::to_string(rows.size() - kMostRows) +
           " more, touched later or not at all</p>";
  }
  return out +
         "<p class=\"note\">held: with the fingers on one side, thumb or palm on the other. "
         "force: sum over the contact points.</p>";
}

std::string caption(const ReportData& data) {
  const std::vector<Touch> touches = numberedTouches(data);
  if (touches.empty()) return "<p class=\"cap\">The hand touched nothing.</p>";
  std::string out = "<p class=\"cap\">Shaded: the hand touches. ";
  for (std::size_t i = 0; i < touches.size(); ++i) {
    const Touch& t = touches[i];
    const bool held = t.held_s > 0.05;
    out += "<span><b>" + std::to_string(i + 1) + "</b> " +
           e(data.bodies[static_cast<std::size_t>(t.body)].name) + (held ? ", held " : ", ") +
           formatShort(held ? t.held_s : t.to_s - t.from_s, "s") + ", " +
           formatNumber(t.largest_force_n, 1) + " N.</span> ";
  }
  if (data.touches.size() > touches.size()) {
    const std::size_t rest = data.touches.size() - touches.size();
    out += "And " + std::to_string(rest) + (rest == 1 ? " lesser touch." : " lesser touches.");
  }
  return out + "</p>";
}

std::string row(const std::string& name, const std::string& value) {
  return "<tr><td>" + e(name) + "</td><td>" + e(value) + "</td></tr>";
}

std::string settingsTable(const ReportData& data) {
  const RecordingMeta& m = data.meta;
  std::string limits, gains = m.paper ? "the paper's own law, " : "";
  gains += m.uncertified ? "NOT certified (--uncertified)" : "accepted";
  for (std::size_t i = 0; i < data.axes.size(); ++i) {
    const ReportAxis& a = data.axes[i];
    const bool same_as_next = i + 1 < data.axes.size() &&
                              data.axes[i + 1].effort_limit == a.effort_limit &&
                              data.axes[i + 1].effort_unit == a.effort_unit;
    limits += axisPen(a.name, static_cast<int>(i)).word;
    limits += same_as_next ? ", "
                           : " " + asStated(a.effort_limit) + " " + a.effort_unit +
                                 (i + 1 < data.axes.size() ? "; " : "");
  }
  std::string out = "<h2>Settings</h2><table class=\"plain tight\"><tbody>";
  for (const char* kind : {"scene", "hand", "device", "rendering", "patient"}) {
    std::string name = embeddedName(m, kind);
    if (!name.empty())
      out += row(std::string(1, static_cast<char>(kind[0] - 32)) + (kind + 1), name);
  }
  out += row("Limits", limits) + row("Gains", gains) + row("Physics engine", m.engine) +
         row("Rate", formatNumber(1.0 / m.period_s, 0) + " Hz, " +
                         (m.simulated_clock ? "simulated clock" : "real time")) +
         row("Damping Φ above 0.5", formatNumber(100.0 * data.damped_share, 0) + " % of the time") +
         row("Largest coupling error of a joint",
             data.summary.max_coupling_error_rad < 1e-10
                 ? "under 0.1 nrad"
                 : formatShort(data.summary.max_coupling_error_rad, "rad"));
  return out + "</tbody></table>";
}

/// What the exercise counts at the end; empty where it counts nothing.
std::string resultTable(const ReportData& data) {
  const RecordingMeta& m = data.meta;
  std::string rows;
  for (std::size_t i = 0; i < m.result_names.size(); ++i) {
    const auto at = std::find(m.value_names.begin(), m.value_names.end(), m.result_names[i]) -
                    m.value_names.begin();
    if (at >= data.summary.value_count) continue;
    const double shown = data.summary.values[static_cast<std::size_t>(at)] * m.result_factors[i];
    const double decimals = std::clamp(m.result_decimals[i], 0.0, 6.0);
    rows += row(m.result_labels[i], formatNumber(shown, static_cast<int>(decimals)) +
                                        (m.result_units[i].empty() ? "" : " " + m.result_units[i]));
  }
  if (rows.empty()) return {};
  return "<div><h2>Result <small>" + e(m.exercise) + ", level " + std::to_string(m.level) +
         "</small></h2><table class=\"plain tight\"><tbody>" + rows + "</tbody></table></div>";
}

std::string stageTable(const ReportData& data) {
  std::string out =
      "<h2>CPU time of a tick <small>µs</small></h2><table "
      "class=\"tight\"><thead><tr><th>Stage</th>"
      "<th>p50</th><th>p99</th><th>p99.9</th><th>max</th></tr></thead><tbody>";
  const auto line = [&out](const std::string& name, const Percentiles& p, const char* style) {
    const auto us = [](double ns) { return "<td>" + formatNumber(ns * 1e-3, 1) + "</td>"; };
    out += std::string("<tr") + style + "><td>" + e(name) + "</td>" + us(p.p50_ns) + us(p.p99_ns) +
           us(p.p999_ns) + us(p.max_ns) + "</tr>";
  };
  for (int i = 0; i < kStages; ++i) {
    std::string name = stageName(static_cast<Stage>(i));
    std::replace(name.begin(), name.end(), '_', ' ');
    line(name, data.summary.stage_cpu[static_cast<std::size_t>(i)], "");
  }
  line("whole tick", data.summary.cpu, " class=\"tot\"");
  return out + "</tbody></table>";
}

std::string footer(const ReportData& data, int page, int pages) {
  return "<footer><span>Program " + e(data.meta.git_version) + ", seed " +
         std::to_string(data.meta.seed) +
         "</span><span>Not a diagnosis. Every number comes from the recording.</span><span>Page " +
         std::to_string(page) + " of " + std::to_string(pages) + "</span></footer>";
}

std::string pictureSheet(const std::vector<EmbeddedPicture>& pictures) {
  std::string out =
      std::string("<section class=\"pictures") + (pictures.size() > 2 ? " many" : "") + "\">";
  for (const EmbeddedPicture& p : pictures) {
    out += "<figure><img alt=\"" + e(p.caption) + "\" src=\"data:image/png;base64," +
           encodeBase64(p.png_bytes) + "\"><figcaption>" + e(p.caption) + "</figcaption></figure>";
  }
  return out + "</section>";
}

}  // namespace

std::string reportPage(const ReportData& data, const std::vector<EmbeddedPicture>& pictures) {
  constexpr std::size_t kPicturesPerSheet = 4;
  const int picture_sheets =
      static_cast<int>((pictures.size() + kPicturesPerSheet - 1) / kPicturesPerSheet);
  const int pages = 2 + picture_sheets;
  const std::string ticks = formatCount(data.summary.records) + " ticks, counts on a log scale" +
                            (data.cpu_time ? ", CPU time" : "");
  std::string out =
      "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">"
      "<meta name=\"viewport\" content=\"width=device-width,initial-scale=1\">"
      "<title>" +
      e(data.meta.title.empty() ? fileName(data.path) : data.meta.title) +
      " – Wholehand</title><link rel=\"icon\" href=\"data:,\"><style>" + kReportStyle +
      "</style></head><body>\n";
  out += "<article class=\"sheet first\">" + header(data) + keyFigures(data) +
         "<section class=\"body\"><div><h2>What the hand felt <small>efforts as sent to the "
         "device; touches found from the data</small></h2>" +
         effortPlots(data, 498) + caption(data) +
         "</div><div class=\"right\"><div>"
         "<h2>Time per tick <small>" +
         ticks + "</small></h2>" + timingPlot(data) + "</div><div>" + bodyTable(data) + "</div>" +
         resultTable(data) + "</div></section>" + footer(data, 1, pages) + "</article>\n";
  out += "<article class=\"sheet\">" + header(data) +
         "<section class=\"body\"><div><h2>How the hand moved <small>thin line: device; wide, pale "
         "line: simulated hand</small></h2>" +
         movementPlots(data, 585) + "</div><div class=\"right\"><div>" + settingsTable(data) +
         "</div><div>" + stageTable(data) + "</div></div></section>" + footer(data, 2, pages) +
         "</article>\n";
  for (int sheet = 0; sheet < picture_sheets; ++sheet) {
    const auto from = pictures.begin() + static_cast<std::ptrdiff_t>(sheet * kPicturesPerSheet);
    const auto count = std::min<std::ptrdiff_t>(kPicturesPerSheet, pictures.end() - from);
    out += "<article class=\"sheet\">" + header(data) + pictureSheet({from, from + count}) +
           footer(data, 3 + sheet, pages) + "</article>\n";
  }
  return out + "<button class=\"print\" onclick=\"print()\">Print</button></body></html>\n";
}

}  // namespace wholehand
