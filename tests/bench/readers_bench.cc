// How fast recordings are read: megabytes of file a second, one thread, from the page cache.
#include <benchmark/benchmark.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>

#include "signal/quality/quality.h"
#include "signal/readers/read_recording.h"
#include "signal/writers/write_uff.h"

namespace {
namespace fs = std::filesystem;
using namespace rigfit::signal;

/// A file of `rows` lines with a time and `channels` columns of `digits` significant digits.
class CsvFile {
 public:
  CsvFile(long rows, int channels, int digits, bool comma) {
    path = fs::temp_directory_path() / ("rigfit_bench_" + std::to_string(::getpid()) + ".csv");
    FILE* file = std::fopen(path.c_str(), "w");
    const char separator = comma ? ';' : ',';
    std::string line = "Time (s)";
    for (int c = 0; c < channels; ++c) line += separator + ("a" + std::to_string(c)) + " [m/s^2]";
    line += '\n';
    std::fwrite(line.data(), 1, line.size(), file);
    char number[48];
    for (long k = 0; k < rows; ++k) {
      std::snprintf(number, sizeof number, "%.6f", static_cast<double>(k) / 51200);
      line = number;
      for (int c = 0; c < channels; ++c) {
        std::snprintf(number, sizeof number, "%.*g", digits,
                      10 * std::sin(0.001 * static_cast<double>(k) * (c + 1)));
        line += separator;
        line += number;
      }
      if (comma) {
        for (char& letter : line) letter = letter == '.' ? ',' : letter;
      }
      line += '\n';
      std::fwrite(line.data(), 1, line.size(), file);
    }
    std::fclose(file);
  }
  ~CsvFile() { fs::remove(path); }
  fs::path path;
};

void ReadCsv(benchmark::State& state) {
  const auto digits = static_cast<int>(state.range(0));
  const CsvFile file(500000, 6, digits, state.range(1) != 0);
  const auto size = static_cast<double>(fs::file_size(file.path));
  for (auto _ : state) {
    benchmark::DoNotOptimize(read_recording(file.path));
  }
  state.counters["MB/s"] = benchmark::Counter(size * 1e-6 * static_cast<double>(state.iterations()),
                                              benchmark::Counter::kIsRate);
  state.counters["file_MB"] = size * 1e-6;
}
BENCHMARK(ReadCsv)
    ->ArgNames({"digits", "decimal_comma"})
    ->Args({6, 0})
    ->Args({9, 0})
    ->Args({15, 0})
    ->Args({17, 0})
    ->Args({9, 1})
    ->Unit(benchmark::kMillisecond);

Recording made_recording() {
  Recording r;
  r.sample_rate_hz = 51200;
  for (int c = 0; c < 6; ++c) {
    Channel channel;
    channel.name = "a" + std::to_string(c);
    channel.unit = "m/s^2";
    channel.quantity = Quantity::acceleration;
    channel.samples.resize(1 << 19);
    for (Eigen::Index k = 0; k < channel.samples.size(); ++k) {
      channel.samples[k] = std::sin(0.001 * static_cast<double>(k) * (c + 1));
    }
    r.channels.push_back(std::move(channel));
  }
  return r;
}

void ReadUff(benchmark::State& state) {
  const auto encoding = state.range(0) != 0 ? UffEncoding::binary : UffEncoding::ascii;
  const std::string text = uff_text(made_recording(), encoding);
  const fs::path path =
      fs::temp_directory_path() / ("rigfit_bench_" + std::to_string(::getpid()) + ".uff");
  std::ofstream(path, std::ios::binary) << text;
  for (auto _ : state) benchmark::DoNotOptimize(read_recording(path));
  state.counters["MB/s"] = benchmark::Counter(
      static_cast<double>(text.size()) * 1e-6 * static_cast<double>(state.iterations()),
      benchmark::Counter::kIsRate);
  fs::remove(path);
}
BENCHMARK(ReadUff)->ArgName("binary")->Arg(0)->Arg(1)->Unit(benchmark::kMillisecond);

void CheckQuality(benchmark::State& state) {
  const Recording r = made_recording();
  for (auto _ : state) benchmark::DoNotOptimize(check_quality(r));
  state.counters["Msamples/s"] = benchmark::Counter(
      6e-6 * static_cast<double>(r.samples()) * static_cast<double>(state.iterations()),
      benchmark::Counter::kIsRate);
}
BENCHMARK(CheckQuality)->Unit(benchmark::kMillisecond);

}  // namespace
