#include "apps/cli/usage.h"

#include <fmt/format.h>

#include <algorithm>

#include "apps/cli/exit_code.h"
#include "apps/cli/key_reference.h"
#include "apps/cli/terminal.h"
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
    text += option.is_file ? " FILE" : kind == "integer" ? " N" : kind[0] == 'n' ? " X" : " WORD";
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
  tension["properties"]["steady_tones"] = describe::schema_of<std::vector<ident::TensionTone>>();
  return {{"$schema", "https://json-schema.org/draft/2020-12/schema"},
          {"title", "results of rigfit, schema version 2"},
          {"$defs", {{"axial", std::move(axial)}, {"tension", std::move(tension)}}}};
}

/// Paragraphs that were broken for a source file in one line each; commands begin with a blank.
std::string unfolded(std::string text) {
  std::size_t begin = 0;
  for (std::size_t at = text.find('\n'); at != std::string::npos; at = text.find('\n', begin)) {
    const bool broken = at - begin > 60 && text[begin] != ' ' && at + 1 < text.size() &&
                        text[at + 1] != ' ' && text[at + 1] != '\n' && text[at - 1] != '.';
    if (broken) {
      text[at] = ' ';
    } else {
      begin = at + 1;
    }
  }
  return text;
}

}  // namespace

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
  return verb.example.empty() ? text
                              : text + '\n' + wrapped(unfolded(verb.example), 0, width) + '\n';
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
  } else if (word == "completion") {
    if (more != "bash" && more != "zsh") {
      throw UsageError("help completion bash, or help completion zsh");
    }
    out << (more == "bash" ? bash_completion(verbs) : zsh_completion(verbs));
  } else if (word == "man") {
    out << man_page(verbs, more.empty() ? nullptr : &verb_named(verbs, more), RIGFIT_VERSION);
  } else {
    auto known = names_of(verbs);
    if (std::find(known.begin(), known.end(), word) == known.end()) {
      for (const char* other : {"scene", "campaign", "sidecar", "schema", "completion", "man"}) {
        known.emplace_back(other);
      }
      throw UsageError("no help on \"" + word + "\"" + did_you_mean(word, known) +
                       " There is help on: " + joined(known));
    }
    out << verb_help(verb_named(verbs, word), text_width());
  }
}

std::string bash_completion(const Verbs& verbs) {
  std::string text =
      "# Completion of rigfit in bash.\n"
      "_rigfit() {\n"
      "  local word=\"${COMP_WORDS[COMP_CWORD]}\" options=\"\"\n"
      "  if [ \"$COMP_CWORD\" -eq 1 ]; then\n";
  text += "    COMPREPLY=($(compgen -W \"" + joined(names_of(verbs)) +
          " help --version\" -- \"$word\"))\n";
  text += "    return\n  fi\n  case \"${COMP_WORDS[1]}\" in\n";
  for (const auto& verb : verbs) {
    text += "    " + verb.name + ") options=\"" + joined(names_of(verb.options)) + "\" ;;\n";
  }
  text += "    help) options=\"" + joined(names_of(verbs)) + " scene campaign sidecar\" ;;\n";
  text +=
      "  esac\n"
      "  case \"$word\" in\n"
      "    -*) COMPREPLY=($(compgen -W \"$options\" -- \"$word\")) ;;\n"
      "    *) [ \"${COMP_WORDS[1]}\" = help ] && COMPREPLY=($(compgen -W \"$options\" -- "
      "\"$word\")) ||\n"
      "         COMPREPLY=($(compgen -f -- \"$word\")) ;;\n"
      "  esac\n"
      "}\n"
      "complete -o filenames -F _rigfit rigfit\n";
  return text;
}

std::string zsh_completion(const Verbs& verbs) {
  std::string text =
      "#compdef rigfit\n"
      "# Completion of rigfit in zsh.\n"
      "_rigfit() {\n"
      "  if (( CURRENT == 2 )); then\n";
  text +=
      "    compadd " + joined(names_of(verbs)) + " help\n    return\n  fi\n  case $words[2] in\n";
  for (const auto& verb : verbs) {
    text += "    " + verb.name + ") [[ $PREFIX == -* ]] && compadd -- " +
            joined(names_of(verb.options)) + " || _files ;;\n";
  }
  text += "    help) compadd " + joined(names_of(verbs)) + " scene campaign sidecar ;;\n";
  text += "  esac\n}\n_rigfit \"$@\"\n";
  return text;
}

std::string man_page(const Verbs& verbs, const Verb* verb, const std::string& version) {
  const std::string title = verb == nullptr ? "rigfit" : "rigfit-" + verb->name;
  std::string text =
      fmt::format(".TH \"{}\" 1 \"\" \"rigfit {}\" \"rigfit\"\n.SH NAME\n{} \\- {}\n", roff(title),
                  version, roff(title), roff(verb == nullptr ? kDoes : verb->does));
  const auto entry = [&](const std::string& word, const std::string& says) {
    text += fmt::format(".TP\n.B {}\n{}\n", roff(word), roff(says));
  };
  if (verb == nullptr) {
    text += ".SH SYNOPSIS\n.B rigfit\nVERB [ARGUMENTS]\n.SH VERBS\n";
    for (const auto& one : verbs) entry(one.name, one.does);
    text += ".PP\nEach verb has a page of its own: rigfit\\-VERB(1).\n";
  } else {
    text += fmt::format(".SH SYNOPSIS\n.B rigfit {}\n", verb->name);
    for (const auto& option : verb->options) {
      if (by_place(option)) text += roff(synopsis(option)) + "\n";
    }
    text += "[OPTIONS]\n.SH OPTIONS\n";
    for (const auto& option : verb->options) entry(synopsis(option), meaning(option));
    if (!verb->example.empty()) text += ".SH NOTES\n.nf\n" + roff(verb->example) + "\n.fi\n";
  }
  return text +
         ".SH EXIT STATUS\n0 done; 2 usage error; 3 unreadable input; 4 refused: the data cannot "
         "support what was asked; 5 did not converge; 1 an internal error.\n";
}

}  // namespace rigfit::apps
