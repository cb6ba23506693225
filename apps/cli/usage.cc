#include "apps/cli/usage.h"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <sstream>
#include <string_view>

#include "apps/campaign/campaign.h"
#include "apps/cli/assets.h"
#include "apps/cli/exit_code.h"
#include "apps/describe/json_of.h"
#include "document/toml_table.h"
#include "ident/campaign/single_tests/axial_campaign.h"
#include "ident/campaign/single_tests/tension_campaign.h"

namespace rigfit::apps {
namespace {
using describe::Option;

constexpr const char* kDoes =
    "Identify cable and beam parameters from test recordings, fit a model, report model vs test.";

std::vector<std::string> names_of(const Verbs& verbs) {
  std::vector<std::string> names;
  for (const auto& verb : verbs) names.push_back(verb.name);
  return names;
}

std::string joined(const std::vector<std::string>& words) {
  return fmt::format("{}", fmt::join(words, " "));
}

bool by_place(const Option& option) { return !option.name.starts_with("--"); }

/// "--length L ...", "FILE ...", "--band X X", "--frame-stiffness X|rigid".
std::string synopsis(const Option& option) {
  const std::string kind = option.kind();
  std::string text = option.name;
  if (by_place(option)) {
    if (!option.value_name.empty()) text = option.value_name;
    std::transform(text.begin(), text.end(), text.begin(), [](char c) { return std::toupper(c); });
  } else if (!option.value_name.empty()) {
    text += " " + option.value_name;
  } else if (!option.words.empty()) {
    text += fmt::format(" {}{}", kind == "number" ? "X|" : "", fmt::join(option.words, "|"));
  } else if (kind == "numbers" && option.numbers > 0) {
    for (int k = 0; k < option.numbers; ++k) text += " X";
  } else if (kind != "flag") {
    text += option.is_written || option.is_file ? " FILE"
            : kind == "integer"                 ? " N"
            : kind[0] == 'n'                    ? " X"
                                                : " WORD";
  }
  return (kind == "numbers" || kind == "texts") && option.numbers == 0 ? text + " ..." : text;
}

/// The meaning with limits and default in brackets.
std::string meaning(const Option& option) {
  std::vector<std::string> more;
  if (option.is_required && !by_place(option)) more.emplace_back("required");
  if (const auto range = range_text(option);
      range.starts_with("from ") && range.find(" to ") != range.npos) {
    more.push_back(range.substr(5));
  }
  if (const auto value = option.default_text(); !value.empty()) more.push_back("default " + value);
  std::string text = option.text();
  if (!more.empty()) text += fmt::format(" ({})", fmt::join(more, "; "));
  return text;
}

void add_options(std::string& text, const describe::Options& options, const std::string& heading,
                 std::size_t width) {
  constexpr std::size_t kIndent = 26;
  bool any = false;
  for (const auto& option : options) {
    if (option.heading != heading) continue;
    if (!any) text += "\n" + (heading.empty() ? std::string("Options") : heading) + ":\n";
    any = true;
    std::string line = "  " + synopsis(option);
    const auto own_std = [&](const Option& other) { return other.name == option.name + "-std"; };
    if (std::any_of(options.begin(), options.end(), own_std)) line += "[,STD]";
    if (line.size() + 2 > kIndent) {
      text += wrapped(line, 6, width) + "\n";
      line.clear();
    }
    line.resize(kIndent, ' ');
    text += wrapped(line + meaning(option), kIndent, width) + "\n";
  }
}

/// Text for roff: backslashes, and lines that begin with a control character.
std::string roff(const std::string& text) {
  std::string out;
  for (std::size_t k = 0; k < text.size(); ++k) {
    const bool begins = k == 0 || text[k - 1] == '\n';
    if (begins && (text[k] == '.' || text[k] == '\'')) out += "\\&";
    if (text[k] == '\\') {
      out += "\\e";
    } else if (text[k] == '-') {
      out += "\\-";
    } else {
      out += text[k];
    }
  }
  return out;
}

/// The JSON schema of described results, built from their descriptions; under `$defs` what each
/// verb of that name gives. A report's document has lists of the same objects by kind of test.
describe::Json result_schema() {
  auto axial = describe::schema_of<ident::AxialTestResult>();
  axial["properties"]["samples"] = describe::schema_of<std::vector<ident::AxialRecord>>();
  auto tension = describe::schema_of<ident::TensionResult>();
  tension["properties"]["peaks"] = describe::schema_of<std::vector<ident::TensionPeak>>();
  return {{"$schema", "https://json-schema.org/draft/2020-12/schema"},
          {"title", "results of rigfit, schema version 2"},
          {"$defs", {{"axial", std::move(axial)}, {"tension", std::move(tension)}}}};
}

using Row = std::vector<std::string>;

/// Cells of "| a | b |", without backticks.
Row cells_of(std::string_view line) {
  Row cells;
  std::size_t at = 1;
  while (at < line.size()) {
    const std::size_t end = std::min(line.find('|', at), line.size());
    std::string cell(line.substr(at, end - at));
    std::erase(cell, '`');
    const std::size_t first = cell.find_first_not_of(' ');
    const std::size_t last = cell.find_last_not_of(' ');
    cells.push_back(first == std::string::npos ? "" : cell.substr(first, last - first + 1));
    at = end + 1;
  }
  return cells;
}

/// The columns under each other; the last one wraps.
std::string aligned(const std::vector<Row>& rows) {
  const std::size_t width = text_width();
  constexpr std::size_t kWidest = 44;
  std::vector<std::size_t> widths;
  for (const auto& row : rows) {
    widths.resize(std::max(widths.size(), row.size()), 0);
    for (std::size_t c = 0; c + 1 < row.size(); ++c) {
      widths[c] = std::min(kWidest, std::max(widths[c], row[c].size()));
    }
  }
  std::string text;
  for (const auto& row : rows) {
    std::string line;
    std::size_t indent = 0;
    for (std::size_t c = 0; c + 1 < row.size(); ++c) {
      line += row[c];
      indent += widths[c] + 2;
      if (line.size() + 2 > indent) {
        text += line + '\n';
        line.clear();
      }
      line.resize(indent, ' ');
    }
    text += wrapped(line + row.back(), indent, std::max(width, indent + 30)) + '\n';
  }
  return text;
}

}  // namespace

std::string key_reference(const std::string& document) {
  if (document == "campaign") {
    std::string text = "Paths are relative to the campaign; `rigfit new` writes one.\n";
    for (const auto& section : campaign_keys()) {
      text += '\n' + section.title + '\n' + aligned(section.rows);
    }
    return text;
  }
  const std::string title = document == "scene"     ? "## Scene\n"
                            : document == "sidecar" ? "## Sidecar\n"
                                                    : "";
  std::string_view page = assets::apps_readme;
  const std::size_t begin = page.find(title);
  if (title.empty() || begin == std::string_view::npos) return "";
  page = page.substr(begin + title.size());
  page = page.substr(0, page.find("\n## "));
  std::string text;
  std::vector<Row> table;
  const auto flush = [&] {
    if (!table.empty()) text += aligned(table);
    table.clear();
  };
  while (!page.empty()) {
    const std::size_t end = std::min(page.find('\n'), page.size());
    const std::string_view line = page.substr(0, end);
    page = page.substr(std::min(page.size(), end + 1));
    if (line.starts_with("|---")) continue;
    if (line.starts_with("|")) {
      table.push_back(cells_of(line));
      continue;
    }
    flush();
    if (line.starts_with("```")) continue;
    std::string plain(line);
    std::erase(plain, '`');
    text += plain + '\n';
  }
  flush();
  text.erase(0, text.find_first_not_of('\n'));
  return text;
}

std::vector<std::string> names_of(const describe::Options& options) {
  std::vector<std::string> names;
  for (const auto& option : options) {
    if (!by_place(option)) names.push_back(option.name);
  }
  return names;
}

std::string did_you_mean(const std::string& word, const std::vector<std::string>& words) {
  const auto nearest = document::nearest_word(word, words);
  return nearest ? "; did you mean " + *nearest + "?" : "";
}

const Verb& verb_named(const Verbs& verbs, const std::string& name) {
  const auto at =
      std::find_if(verbs.begin(), verbs.end(), [&](const Verb& verb) { return verb.name == name; });
  if (at != verbs.end()) return *at;
  throw UsageError(fmt::format("there is no verb \"{}\"{}\nrigfit help lists the verbs.", name,
                               did_you_mean(name, names_of(verbs))));
}

std::string program_help(const Verbs& verbs, std::size_t width) {
  std::string text = wrapped(kDoes, 0, width) + "\n\nUsage: rigfit VERB ...\n\nVerbs:\n";
  for (const auto& verb : verbs) {
    text += wrapped(fmt::format("  {:<12}{}", verb.name, verb.does), 14, width) + "\n";
  }
  return text + '\n' +
         wrapped(
             "rigfit help VERB: options and an example. rigfit help scene|campaign|sidecar: "
             "every key of these files. rigfit help schema: JSON schema of results.\n",
             0, width) +
         "\n";
}

std::string verb_help(const Verb& verb, std::size_t width) {
  std::string usage = "Usage: rigfit " + verb.name;
  for (const auto& option : verb.options) {
    if (by_place(option) || option.is_required) usage += " " + synopsis(option);
  }
  std::string text =
      wrapped(verb.does, 0, width) + "\n\n" + wrapped(usage + " [OPTIONS]", 4, width) + "\n";
  std::vector<std::string> headings{""};
  for (const auto& option : verb.options) {
    if (std::find(headings.begin(), headings.end(), option.heading) == headings.end()) {
      headings.push_back(option.heading);
    }
  }
  for (const auto& heading : headings) add_options(text, verb.options, heading, width);
  return verb.example.empty() ? text : text + '\n' + wrapped(verb.example, 0, width) + '\n';
}

void help(const Verbs& verbs, const std::vector<std::string>& arguments, std::ostream& out) {
  const std::string word = arguments.empty() ? "" : arguments[0];
  const std::string more = arguments.size() > 1 ? arguments[1] : "";
  if (word.empty()) {
    out << program_help(verbs, text_width());
  } else if (const auto keys = key_reference(word); !keys.empty()) {
    out << keys;
  } else if (word == "schema") {
    out << result_schema().dump(2) << '\n';
  } else if (word == "man") {
    out << man_page(verbs, more.empty() ? nullptr : &verb_named(verbs, more), RIGFIT_VERSION);
  } else {
    auto known = names_of(verbs);
    if (std::find(known.begin(), known.end(), word) == known.end()) {
      for (const char* other : {"scene", "campaign", "sidecar", "schema", "man"}) {
        known.emplace_back(other);
      }
      throw UsageError("no help on \"" + word + "\"" + did_you_mean(word, known) +
                       " There is help on: " + joined(known));
    }
    out << verb_help(verb_named(verbs, word), text_width());
  }
}

std::string man_page(const Verbs& verbs, const Verb* verb, const std::string& version) {
  const std::string title = verb == nullptr ? "rigfit" : "rigfit-" + verb->name;
  return fmt::format(
      ".TH \"{0}\" 1 \"\" \"rigfit {1}\" \"rigfit\"\n.SH NAME\n{0} \\- {2}\n.SH "
      "DESCRIPTION\n.nf\n{3}"
      ".fi\n.SH EXIT STATUS\n0 done; 2 usage error; 3 unreadable input; 4 refused: the data cannot "
      "support what was asked; 5 did not converge; 1 an internal error.\n",
      roff(title), version, roff(verb == nullptr ? kDoes : verb->does),
      roff(verb == nullptr ? program_help(verbs, 78) : verb_help(*verb, 78)));
}

std::size_t text_width() {
  winsize size{};
  const bool known = ::ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col >= 40;
  return known ? size.ws_col : 80;
}

std::string wrapped(const std::string& text, std::size_t indent, std::size_t width) {
  std::string result;
  std::size_t column = 0;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line); column = 0) {
    if (!result.empty()) result += '\n';
    const bool kept = indent == 0 && line.starts_with(' ');
    std::size_t at = 0;
    while (!kept && line.size() - at > width - column) {
      // What stands before the indentation is never parted from its text.
      const std::size_t least = at + (at == 0 && indent > 0 ? indent : 1);
      std::size_t cut = line.rfind(' ', at + width - column);
      if (cut == std::string::npos || cut < least) cut = line.find(' ', least);
      if (cut == std::string::npos) break;
      result += line.substr(at, cut - at) + '\n' + std::string(indent, ' ');
      column = indent;
      at = cut + 1;
    }
    result += line.substr(at);
  }
  return result;
}

}  // namespace rigfit::apps
