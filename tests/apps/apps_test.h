// What tests of the program include: what all tests do, JSON, files and text, runs of the program.
#pragma once

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <nlohmann/json.hpp>
#include <sstream>

#include "tests/apps/run_program.h"
#include "tests/test.h"

namespace rigfit::apps {
/// What the program wrote as JSON, with its keys in the order of the alphabet.
using Document = nlohmann::json;
}  // namespace rigfit::apps
