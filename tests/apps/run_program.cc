#include "tests/apps/run_program.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <iomanip>
#include <nlohmann/json.hpp>
#include <sstream>
#include <stdexcept>

#include "tests/apps/json_schema.h"

namespace rigfit::apps {
nlohmann::json parsed(const std::string& text) {
  return nlohmann::json::parse(text, nullptr, false);
}

pid_t start_program(const std::vector<std::string>& arguments, const TemporaryFolder& folder) {
  const std::string out = folder.at("out"), err = folder.at("err");
  std::vector<std::string> words{RIGFIT_PROGRAM};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> pointers;
  for (auto& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  const pid_t child = ::fork();
  if (child < 0) throw std::runtime_error("cannot fork");
  if (child == 0) {
    const int out_file = ::open(out.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
    const int err_file = ::open(err.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
    const int nothing = ::open("/dev/null", O_RDONLY);
    if (out_file < 0 || err_file < 0 || nothing < 0) ::_exit(127);
    ::dup2(nothing, STDIN_FILENO);
    ::dup2(out_file, STDOUT_FILENO);
    ::dup2(err_file, STDERR_FILENO);
    ::execv(pointers[0], pointers.data());
    ::_exit(127);
  }
  return child;
}

ProgramRun run_program(const std::vector<std::string>& arguments) {
  const TemporaryFolder folder;
  const pid_t child = start_program(arguments, folder);
  int status = 0;
  ::waitpid(child, &status, 0);
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, folder.read("out"), folder.read("err")};
}

ProgramRun run_line(const std::string& line, const std::vector<std::string>& values) {
  std::vector<std::string> words;
  std::istringstream stream(line);
  for (std::string word; stream >> std::quoted(word, '\'');) {
    if (word.starts_with('$')) word.replace(0, 1, RIGFIT_TESTDATA);
    words.push_back(std::move(word));
  }
  auto value = values.begin();
  for (std::string& word : words) {
    for (auto at = word.find("{}"); at != std::string::npos; at = word.find("{}", at)) {
      word.replace(at, 2, *value);
      at += (value++)->size();
    }
  }
  if (value != values.end()) throw std::logic_error("more values than {}: " + line);
  return run_program(words);
}

nlohmann::json document_of(const std::string& line, const std::vector<std::string>& values) {
  const ProgramRun run = run_line(line + " --json -", values);
  EXPECT_EQ(run.exit_code, 0) << line << "\n" << run.err;
  static const nlohmann::json schemas = parsed(run_line("help schema").out)["$defs"];
  nlohmann::json document = parsed(run.out);
  const std::string verb = line.substr(0, line.find(' '));
  EXPECT_EQ(schema_errors(document, schemas.at(verb)), std::vector<std::string>{}) << line;
  return document;
}

std::vector<std::vector<double>> columns(const std::string& csv, std::string* header) {
  std::istringstream lines(csv);
  std::string line, field;
  std::getline(lines, *header);
  std::vector<std::vector<double>> result;
  while (std::getline(lines, line)) {
    std::istringstream fields(line);
    for (std::size_t k = 0; std::getline(fields, field, ','); ++k) {
      if (k == result.size()) result.emplace_back();
      result[k].push_back(std::stod(field));
    }
  }
  return result;
}

}  // namespace rigfit::apps
