#pragma once

namespace wholehand {

/// The report's style sheet: A4 landscape sheets (1123 x 794 CSS px), black on white, no font or
/// picture from outside.
inline constexpr const char* kReportStyle = R"css(
@page { size: A4 landscape; margin: 0; }
:root { --ink: #1B1714; --ink-2: #554D46; --rule: #CFC8BD; --bad: #A1141A; }
* { box-sizing: border-box; }
body { margin: 0; background: #D9D5CE; color: var(--ink); font: 13px/1.35 'Atkinson Hyperlegible Next', 'Atkinson Hyperlegible', system-ui, 'Segoe UI', Roboto, 'Helvetica Neue', Arial, 'Noto Sans', 'DejaVu Sans', sans-serif; }
.sheet { width: 1123px; height: 794px; margin: 8px auto; background: #fff; padding: 28px 40px 18px; display: grid; grid-template-rows: auto 1fr auto; gap: 12px; box-shadow: 0 2px 20px #0003; overflow: hidden; break-after: page; }
.sheet.first { grid-template-rows: auto auto 1fr auto; }
header { display: flex; align-items: flex-end; gap: 26px; border-bottom: 2px solid var(--ink); padding-bottom: 9px; }
header > div { min-width: 0; }
h1 { font-size: 25px; line-height: 1.15; margin: 2px 0 0; letter-spacing: -.01em; white-space: nowrap; overflow: hidden; text-overflow: ellipsis; }
header .k { color: var(--ink-2); }
header dl { margin: 0 0 0 auto; display: flex; gap: 22px; white-space: nowrap; flex: none; }
dt { color: var(--ink-2); }
dd { margin: 0; font-weight: 650; font-variant-numeric: tabular-nums; max-width: 260px; overflow: hidden; text-overflow: ellipsis; }
.sum { display: grid; grid-template-columns: repeat(6, auto); justify-content: space-between; }
.sum div { padding: 0 14px; border-left: 1px solid var(--rule); }
.sum div:first-child { padding-left: 0; border: 0; }
.sum b { display: block; font-size: 27px; line-height: 1.15; font-weight: 700; letter-spacing: -.01em; white-space: nowrap; }
.sum small { font-size: 15px; font-weight: 450; color: var(--ink-2); letter-spacing: 0; }
.sum span { color: var(--ink-2); }
.body { display: grid; grid-template-columns: 657px 356px; gap: 30px; min-height: 0; }
h2 { font-size: 15px; margin: 0 0 4px; }
h2 small { font-weight: 450; color: var(--ink-2); font-size: 13px; }
.cap { margin: 5px 0 0 40px; font-size: 12px; color: var(--ink-2); }
.cap span { white-space: nowrap; }
.cap b { color: var(--ink); }
.note { margin: 4px 0 0; font-size: 12px; color: var(--ink-2); }
.right { display: flex; flex-direction: column; gap: 18px; }
svg { display: block; }
table { border-collapse: collapse; width: 100%; font-variant-numeric: tabular-nums; }
th { text-align: right; font-weight: 450; color: var(--ink-2); border-bottom: 1.5px solid var(--ink); padding: 2px 0 4px 6px; vertical-align: bottom; line-height: 1.15; }
td { text-align: right; padding: 3.5px 0 3.5px 6px; border-bottom: 1px solid var(--rule); }
th:first-child, td:first-child { text-align: left; padding-left: 0; }
td:first-child { font-weight: 650; }
.tight td { padding-top: 2px; padding-bottom: 2px; }
.plain td:first-child { font-weight: 450; white-space: nowrap; vertical-align: top; }
tr.tot td { border-bottom: 0; font-weight: 700; }
.pictures { display: grid; grid-template-columns: repeat(auto-fit, minmax(430px, 1fr)); gap: 14px; min-height: 0; align-content: start; }
figure { margin: 0; min-height: 0; }
figure img { display: block; width: 100%; max-height: 560px; object-fit: contain; border-radius: 6px; }
.many img { max-height: 268px; }
figcaption { margin-top: 4px; color: var(--ink-2); }
footer { display: flex; gap: 20px; color: var(--ink-2); border-top: 1px solid var(--rule); padding-top: 7px; font-size: 12px; }
footer span:last-child { margin-left: auto; }
.print { position: fixed; right: 12px; top: 12px; font: inherit; border: 1px solid var(--ink-2); background: #fff; color: var(--ink); border-radius: 9px; min-height: 44px; padding: 0 14px; font-weight: 650; }
.print:focus-visible { outline: 3px solid #0B57D0; outline-offset: 2px; }
@media print { body { background: #fff; } .sheet { margin: 0; box-shadow: none; } .sheet:last-of-type { break-after: auto; } .print { display: none; } * { print-color-adjust: exact; } }
)css";

}  // namespace wholehand
