#include "apps/cli/usage.h"

#include <fmt/format.h>

#include <algorithm>

#include "apps/cli/exit_code.h"
#include "apps/cli/key_reference.h"
#include "document/toml_table.h"

namespace rigfit::apps {
namespace {

const Verb* verb_named(const Verbs& verbs, const std::string& name) {
  const auto at = std::find_if(verbs.begin(), verbs.end(),
                               [&](const Verb& verb) { return verb.app->get_name() == name; });
  return at == verbs.end() ? nullptr : &*at;
}

std::vector<std::string> names_of(const Verbs& verbs) {
  std::vector<std::string> names;
  for (const auto& verb : verbs) names.push_back(verb.app->get_name());
  return names;
}

/// "--band", "-h" ... of a verb, in its order.
std::vector<std::string> options_of(const Verb& verb) {
  std::vector<std::string> names;
  for (const CLI::Option* option : std::as_const(*verb.app).get_options()) {
    for (const auto& name : option->get_lnames()) names.push_back("--" + name);
  }
  return names;
}

std::string did_you_mean(const std::string& word, const std::vector<std::string>& words) {
  const auto nearest = document::nearest_word(word, words);
  return nearest ? "; did you mean " + *nearest + "?" : "";
}

std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (const auto& word : words) text += (text.empty() ? "" : " ") + word;
  return text;
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

/// "NUMBER in [0 - 1]" for CLI11's "FLOAT:FLOAT in [0 - 1]", "FILE" for "TEXT:FILE".
std::string plain_type(const std::string& type) {
  const auto colon = type.find(':');
  std::string word = type.substr(0, colon);
  const std::string check = colon == std::string::npos ? "" : type.substr(colon + 1);
  if (word == "FLOAT") word = "NUMBER";
  if (word == "INT" || word == "UINT") word = "INTEGER";
  if (const auto range = check.find(" in ["); range != std::string::npos) {
    return word + check.substr(range);
  }
  if (check == "POSITIVE" || check == "NONNEGATIVE") return check + " " + word;
  return word == "TEXT" && !check.empty() ? check : word;
}

class HelpFormatter : public CLI::Formatter {
 public:
  std::string make_option_opts(const CLI::Option* option) const override {
    std::string text = CLI::Formatter::make_option_opts(option);
    const std::string type = option->get_type_name();
    const auto at = type.empty() ? std::string::npos : text.find(type);
    if (at != std::string::npos) text.replace(at, type.size(), plain_type(type));
    return text;
  }
  std::string make_option_usage(const CLI::Option* option) const override {
    const std::string name = option->get_name(true) + (option->get_expected_max() > 1 ? "..." : "");
    return option->get_required() ? name : "[" + name + "]";
  }
};

}  // namespace

std::shared_ptr<CLI::FormatterBase> help_formatter() { return std::make_shared<HelpFormatter>(); }

int help(CLI::App& program, const Verbs& verbs, const std::vector<std::string>& arguments,
         std::ostream& out) {
  if (arguments.empty()) {
    out << program.help() << "\nrigfit help VERB: options and an example. rigfit help "
        << "scene|campaign|sidecar: every key of these files.\n";
    return 0;
  }
  const std::string& word = arguments.front();
  if (const Verb* verb = verb_named(verbs, word)) {
    out << verb->app->help(program.get_name());
    return 0;
  }
  if (const auto text = key_reference(word); !text.empty()) {
    out << text;
    return 0;
  }
  if (word == "completion") {
    const std::string shell = arguments.size() > 1 ? arguments[1] : "";
    if (shell == "bash" || shell == "zsh") {
      out << (shell == "bash" ? bash_completion(verbs) : zsh_completion(verbs));
      return 0;
    }
    throw UsageError("help completion bash, or help completion zsh");
  }
  if (word == "man") {
    const Verb* const verb = arguments.size() > 1 ? verb_named(verbs, arguments[1]) : nullptr;
    if (arguments.size() > 1 && verb == nullptr) {
      throw UsageError("there is no verb \"" + arguments[1] + "\"" +
                       did_you_mean(arguments[1], names_of(verbs)));
    }
    out << man_page(program, verbs, verb, RIGFIT_VERSION);
    return 0;
  }
  auto known = names_of(verbs);
  for (const char* other : {"scene", "campaign", "sidecar", "completion", "man"}) {
    known.emplace_back(other);
  }
  throw UsageError("no help on \"" + word + "\"" + did_you_mean(word, known) +
                   " There is help on: " + joined(known));
}

std::string usage_error(const Verbs& verbs, const std::vector<std::string>& arguments,
                        const std::string& message) {
  const auto word = std::find_if(arguments.begin(), arguments.end(), [](const std::string& text) {
    return !text.empty() && text.front() != '-';
  });
  if (word == arguments.end()) return message;
  const Verb* const verb = verb_named(verbs, *word);
  if (verb == nullptr) {
    return fmt::format("there is no verb \"{}\"{}\nrigfit help lists the verbs.", *word,
                       did_you_mean(*word, names_of(verbs)));
  }
  for (const auto& text : arguments) {
    if (text.size() < 3 || text.substr(0, 2) != "--") continue;
    const std::string name = text.substr(0, text.find('='));
    const auto known = options_of(*verb);
    if (std::find(known.begin(), known.end(), name) != known.end()) continue;
    return fmt::format("rigfit {} has no option {}{}\nrigfit help {} lists its options.", *word,
                       name, did_you_mean(name, known), *word);
  }
  return message + "\nrigfit help " + *word + " says how it is used.";
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
    text += "    " + verb.app->get_name() + ") options=\"" + joined(options_of(verb)) + "\" ;;\n";
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
    text += "    " + verb.app->get_name() + ") [[ $PREFIX == -* ]] && compadd -- " +
            joined(options_of(verb)) + " || _files ;;\n";
  }
  text += "    help) compadd " + joined(names_of(verbs)) + " scene campaign sidecar ;;\n";
  text += "  esac\n}\n_rigfit \"$@\"\n";
  return text;
}

std::string man_page(const CLI::App& program, const Verbs& verbs, const Verb* verb,
                     const std::string& version) {
  const std::string title = verb == nullptr ? "rigfit" : "rigfit-" + verb->app->get_name();
  const CLI::App& app = verb == nullptr ? program : *verb->app;
  std::string text =
      fmt::format(".TH \"{}\" 1 \"\" \"rigfit {}\" \"rigfit\"\n.SH NAME\n{} \\- {}\n", roff(title),
                  version, roff(title), roff(app.get_description()));
  if (verb == nullptr) {
    text += ".SH SYNOPSIS\n.B rigfit\nVERB [ARGUMENTS]\n.SH VERBS\n";
    for (const auto& one : verbs) {
      text += fmt::format(".TP\n.B {}\n{}\n", roff(one.app->get_name()),
                          roff(one.app->get_description()));
    }
    text += ".PP\nEach verb has a page of its own: rigfit\\-VERB(1).\n";
  } else {
    text += fmt::format(".SH SYNOPSIS\n.B rigfit {}\n", verb->app->get_name());
    for (const CLI::Option* option : std::as_const(*verb->app).get_options()) {
      if (option->get_positional()) text += roff(option->get_name(true, false)) + "\n";
    }
    text += "[OPTIONS]\n.SH OPTIONS\n";
    for (const CLI::Option* option : std::as_const(*verb->app).get_options()) {
      text += fmt::format(".TP\n.B {}\n{}\n", roff(option->get_name(true, true)),
                          roff(option->get_description()));
    }
    if (!app.get_footer().empty()) text += ".SH NOTES\n.nf\n" + roff(app.get_footer()) + "\n.fi\n";
  }
  text +=
      ".SH EXIT STATUS\n0 done; 2 wrong usage; 3 an input cannot be read; 4 refused: the data "
      "cannot "
      "support what was asked; 5 did not converge; 1 an internal error.\n";
  return text;
}

}  // namespace rigfit::apps
