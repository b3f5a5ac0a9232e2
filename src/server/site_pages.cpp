#include "server/site.hpp"

#include <fmt/format.h>

namespace wholehand {

HttpAnswer plainRefusal(int status, const char* reason, const char* why) {
  HttpAnswer a;
  a.status = status;
  a.content_type = "text/html; charset=utf-8";
  a.body = plainPage(reason, std::string("<p>") + why + "</p>");
  a.refused = reason;
  return a;
}

// Uses the colours and fonts of the game's pages.
std::string plainPage(std::string_view title, std::string_view body_html) {
  return fmt::format(R"(<!doctype html>
<html lang="en"><head><meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>{0} · Wholehand</title>
<style>
:root {{ color-scheme: light dark; --ink: #16202a; --paper: #f6f4ef; --line: #c9c4b8; --blue: #1f5fa8; }}
@media (prefers-color-scheme: dark) {{
  :root {{ --ink: #eef1f4; --paper: #12181f; --line: #3a4653; --blue: #8fc1ff; }} }}
body {{ margin: 0; min-height: 100vh; display: grid; place-items: center; background: var(--paper);
  color: var(--ink); font: 1.25rem/1.5 system-ui, sans-serif; }}
main {{ max-width: 36rem; padding: 2rem; border-left: 6px solid var(--blue); }}
h1 {{ margin: 0 0 .5rem; font-size: 2.25rem; line-height: 1.15; }}
a {{ color: var(--blue); }}
code {{ font-size: 1.1rem; overflow-wrap: anywhere; }}
pre {{ padding: .75rem 1rem; border: 1px solid var(--line); border-radius: 8px; overflow: auto; }}
</style></head><body><main><h1>{0}</h1>{1}</main></body></html>
)",
                     title, body_html);
}

}  // namespace wholehand
