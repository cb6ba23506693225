#include <sys/ioctl.h>
#include <unistd.h>

#include <regex>
#include <sstream>

#include "apps/campaign/campaign.h"
#include "apps/cli/assets.h"
#include "apps/cli/verb.h"
#include "document/toml_table.h"

namespace rigfit::apps {
namespace {
using describe::Option;

constexpr const char* kDoes =
    "Identify cable and beam parameters from test recordings, fit a model, report model vs test.";

std::vector<std::string> names_of(const Verbs& verbs) {
  std::vector<std::string> names;
  std::ranges::transform(verbs, std::back_inserter(names), &Verb::name);
  return names;
}

/// Columns of the terminal that standard output is; 80 elsewhere.
std::size_t text_width() {
  winsize size{};
  const bool known = ::ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col >= 40;
  return known ? size.ws_col : 80;
}

/// `text` broken at blanks to `width` columns, every line but the first begun with `indent` blanks;
/// lines that begin with a blank (commands) stay as they are.
std::string wrapped(const std::string& text, std::size_t indent, std::size_t width) {
  std::string result;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    if (!result.empty()) result += '\n';
    while (line.size() > width && (indent > 0 || !line.starts_with(' '))) {
      // What stands before the indentation is never parted from its text.
      std::size_t cut = line.rfind(' ', width);
      if (cut == std::string::npos || cut <= indent) cut = line.find(' ', indent + 1);
      if (cut == std::string::npos) break;
      result += line.substr(0, cut) + '\n';
      line = std::string(indent, ' ') + line.substr(cut + 1);
    }
    result += line;
  }
  return result;
}

bool by_place(const Option& option) { return !option.name.starts_with("--"); }

/// "--length L ...", "FILE ...", "--band X X", "--frame-stiffness X|rigid".
std::string synopsis(const Option& option) {
  std::string text = option.name;
  if (by_place(option)) {
    if (!option.value_name.empty()) text = option.value_name;
    std::ranges::transform(text, text.begin(), [](char c) { return std::toupper(c); });
  } else if (!option.value_name.empty()) {
    text += " " + option.value_name;
  } else if (!option.words.empty()) {
    text += fmt::format(" {}{}", option.kind == describe::Kind::number ? "X|" : "",
                        fmt::join(option.words, "|"));
  } else if (option.kind != describe::Kind::flag) {
    const char* const value =
        option.is_written || option.is_file                                               ? " FILE"
        : option.kind == describe::Kind::integer                                          ? " N"
        : option.kind == describe::Kind::number || option.kind == describe::Kind::numbers ? " X"
                                                                                          : " WORD";
    for (int k = 0; k < std::max(1, option.numbers); ++k) text += value;
  }
  return option.is_list() && option.numbers == 0 ? text + " ..." : text;
}

/// The meaning with limits and default in brackets; of a key of a file also its words.
std::string meaning(const Option& option, bool key) {
  std::vector<std::string> more;
  if (key && !option.words.empty()) {
    more.push_back(fmt::format("\"{}\"", fmt::join(option.words, "\", \"")));
  }
  if (option.is_required && (key || !by_place(option))) more.emplace_back("required");
  if (std::isfinite(option.highest)) {
    more.push_back(fmt::format("{:g} to {:g}", option.lowest, option.highest));
  }
  if (const auto value = option.default_text(); !value.empty()) more.push_back("default " + value);
  for (const auto& other : option.only_with) {
    if (key) more.push_back("with " + other);
  }
  std::string text = option.text();
  if (!more.empty()) text += fmt::format(" ({})", fmt::join(more, "; "));
  return text;
}

/// A name and its meaning beside it, or below where the name is long.
void add_row(std::string& text, const std::string& name, const std::string& meaning,
             std::size_t width) {
  constexpr std::size_t kIndent = 26;
  std::string line = "  " + name;
  if (line.size() + 2 > kIndent) {
    text += wrapped(line, 6, width) + "\n";
    line.clear();
  }
  line.resize(kIndent, ' ');
  text += wrapped(line + meaning, kIndent, width) + "\n";
}

/// Options, or keys of a file, below their headings.
std::string options_text(const describe::Options& options, bool keys, std::size_t width) {
  std::string text, heading = "\n";
  for (const auto& option : options) {
    if (option.heading != heading) {
      heading = option.heading;
      text += "\n" + (heading.empty() ? std::string("Options") : heading) + (keys ? "\n" : ":\n");
    }
    const bool has_std =
        std::ranges::find(options, option.name + "-std", &Option::name) != options.end();
    add_row(text, keys ? option.name : synopsis(option) + (has_std ? "[,STD]" : ""),
            meaning(option, keys), width);
  }
  return text;
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

/// The JSON schema of described results, built from their descriptions; under `$defs` what each
/// verb of that name gives that found an answer. A report's document has lists of the same objects
/// by kind of test.
Json result_schema(const Verbs& verbs) {
  Json all{
      {"$schema", "https://json-schema.org/draft/2020-12/schema"},
      {"title", "results of rigfit, schema version 2; one with exit code 4 or 5 may lack keys"}};
  for (const auto& verb : verbs) {
    all["$defs"][verb.name] = verb.schema();
  }
  return all;
}

}  // namespace

std::string key_reference(const std::string& document) {
  const std::size_t width = text_width();
  if (document == "campaign") {
    return "Paths are relative to the campaign; `rigfit new` writes one.\n" +
           options_text(campaign_keys(), true, width);
  }
  const std::string title = document == "scene"     ? "## Scene\n"
                            : document == "sidecar" ? "## Sidecar\n"
                                                    : "";
  std::string page(assets::apps_readme);
  const std::size_t begin = page.find(title);
  if (title.empty() || begin == std::string::npos) return "";
  page = page.substr(begin + title.size());
  std::erase(page, '`');
  std::istringstream lines(page.substr(0, page.find("\n## ")));
  std::string text;
  const std::regex row(R"(\| *(.*?) *\| *(.*?) *\| *(.*?) *\| *(.*?) *\|)");
  std::smatch cells;  // table, key, unit, meaning
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with("|---") || line == "toml") continue;  // rules and fences
    if (std::regex_match(line, cells, row)) {
      const auto both = [&](int first, const char* between) {
        const bool two = cells[first].length() > 0 && cells[first + 1].length() > 0;
        return cells[first].str() + (two ? between : "") + cells[first + 1].str();
      };
      add_row(text, both(1, " "), both(3, "; "), width);
    } else if (!line.empty() || !text.empty()) {
      text += wrapped(line, 0, width) + '\n';
    }
  }
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
  const auto at = std::ranges::find(verbs, name, &Verb::name);
  if (at != verbs.end()) return *at;
  throw UsageError(fmt::format("there is no verb \"{}\"{}\nrigfit help lists the verbs.", name,
                               did_you_mean(name, names_of(verbs))));
}

std::string verb_help(const Verb& verb, std::size_t width) {
  std::string usage = "Usage: rigfit " + verb.name;
  for (const auto& option : verb.options) {
    if (by_place(option) || option.is_required) usage += " " + synopsis(option);
  }
  std::string text =
      wrapped(verb.does, 0, width) + "\n\n" + wrapped(usage + " [OPTIONS]", 4, width) + "\n";
  text += options_text(verb.options, false, width);
  return verb.example.empty() ? text : text + '\n' + wrapped(verb.example, 0, width) + '\n';
}

void help(const Verbs& verbs, const std::vector<std::string>& arguments, std::ostream& out) {
  const std::string word = arguments.empty() ? "" : arguments[0];
  if (word.empty()) {
    out << program_help(verbs, text_width());
  } else if (const auto keys = key_reference(word); !keys.empty()) {
    out << keys;
  } else if (word == "schema") {
    out << result_schema(verbs).dump(2) << '\n';
  } else {
    auto known = names_of(verbs);
    if (std::ranges::find(known, word) == known.end()) {
      known.insert(known.end(), {"scene", "campaign", "sidecar", "schema"});
      throw UsageError(fmt::format("no help on \"{}\"{} There is help on: {}", word,
                                   did_you_mean(word, known), fmt::join(known, " ")));
    }
    out << verb_help(verb_named(verbs, word), text_width());
  }
}

}  // namespace rigfit::apps
