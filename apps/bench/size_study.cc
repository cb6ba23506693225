#include "apps/bench/size_study.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <malloc.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <filesystem>
#include <fstream>
#include <memory>
#include <numbers>
#include <random>

#include "apps/bench/bench_scenes.h"
#include "apps/bench/bench_study.h"
#include "apps/bench/model_studies.h"
#include "apps/bench/ten_modes.h"
#include "apps/bench/utility_line.h"
#include "model/frfs/frf_synthesis.h"
#include "model/linear/modes.h"
#include "signal/decay/decay.h"
#include "signal/modal/modal_identification.h"
#include "signal/poles/lscf.h"
#include "signal/quality/quality.h"
#include "signal/readers/read_recording.h"
#include "signal/spectra/frf.h"

namespace rigfit::apps {
namespace {
namespace fs = std::filesystem;
using Eigen::Index;

/// A line "Name: 123 kB" of a file of /proc, in bytes; nothing where there is none.
std::optional<double> kilobytes_of(const char* file, const std::string& name) {
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);) {
    if (line.rfind(name + ":", 0) == 0) return 1024 * std::stod(line.substr(name.size() + 1));
  }
  return {};
}

/// Runs `work` and returns the peak of resident memory over what there was before.
std::optional<double> peak_of(const std::function<void()>& work) {
  ::malloc_trim(0);
  bool reset = false;
  const int file = ::open("/proc/self/clear_refs", O_WRONLY | O_CLOEXEC);
  if (file >= 0) {
    reset = ::write(file, "5", 1) == 1;  // the peak begins anew
    ::close(file);
  }
  const auto before = kilobytes_of("/proc/self/status", "VmRSS");
  work();
  const auto peak = kilobytes_of("/proc/self/status", "VmHWM");
  if (!reset || !before || !peak) return {};
  return std::max(0.0, *peak - *before);
}

/// What a size is about to work on, and the work.
struct Case {
  std::function<void()> work;
  std::shared_ptr<void> keep;
};

class Study {
 public:
  Study(const SizeLimits& limits, const std::function<void(const SizeSeries&)>& done)
      : limits_(limits), done_(done) {}

  void series(const char* task, const char* method, const char* size_of,
              const std::vector<double>& sizes, const std::function<Case(double)>& make) {
    SizeSeries out{task, method, size_of, {}, {}, {}, {}};
    const double last = sizes.back() * limits_.largest_share;
    for (const double size : sizes) {
      if (size > last * (1 + 1e-9)) break;
      if (!out.rows.empty() && !may(out, size)) break;
      SizeRow row;
      row.size = size;
      BenchBudget budget;
      budget.repeats = 5;
      row.peak_bytes = peak_of([&] {
        const Case one = make(size);
        row.wall_s = median_time(budget, one.work);
      });
      out.rows.push_back(row);
    }
    if (out.rows.size() >= 3) {
      std::vector<double> x, t, m;
      for (auto row = out.rows.end() - 3; row != out.rows.end(); ++row) {
        x.push_back(row->size);
        t.push_back(row->wall_s);
        if (row->peak_bytes.value_or(0) > 0) m.push_back(*row->peak_bytes);
      }
      out.time_slope = log_slope(x, t);
      if (m.size() == x.size()) out.memory_slope = log_slope(x, m);
    }
    done_(out);
  }

 private:
  /// Whether the next size is within the limits, by the last two rows' slope.
  bool may(SizeSeries& out, double size) const {
    const SizeRow& last = out.rows.back();
    const double ratio = size / last.size;
    double slope = 1;
    if (out.rows.size() > 1) {
      const SizeRow& before = out.rows[out.rows.size() - 2];
      slope = std::clamp(std::log(last.wall_s / before.wall_s) / std::log(last.size / before.size),
                         1.0, 3.0);
    }
    const double seconds = last.wall_s * std::pow(ratio, slope);
    if (seconds > limits_.seconds) {
      out.stopped =
          fmt::format("at {:g}: {:g} would take about {}", last.size, size, time_words(seconds));
      return false;
    }
    const double bytes = ratio * last.peak_bytes.value_or(0);
    const double free = kilobytes_of("/proc/meminfo", "MemAvailable").value_or(1e300);
    if (bytes > limits_.memory_share * free) {
      out.stopped =
          fmt::format("at {:g}: {:g} would take about {:.2g} GB", last.size, size, 1e-9 * bytes);
      return false;
    }
    return true;
  }

  SizeLimits limits_;
  const std::function<void(const SizeSeries&)>& done_;
};

std::vector<double> thirds(double from, double to) {
  std::vector<double> sizes;
  for (double decade = from; decade <= to * (1 + 1e-9); decade *= 10) {
    sizes.push_back(decade);
    if (3 * decade <= to * (1 + 1e-9)) sizes.push_back(3 * decade);
  }
  return sizes;
}

std::vector<double> whole_decades(double from, double to) {
  std::vector<double> sizes;
  for (double decade = from; decade <= to * (1 + 1e-9); decade *= 10) sizes.push_back(decade);
  return sizes;
}

model::ModesOptions first_modes(int count) {
  model::ModesOptions options;
  options.count = count;
  return options;
}

void by_segments(Study& study) {
  const auto sizes = thirds(10, 10000);
  const auto cable = [](double n) {
    return std::make_shared<model::Scene>(with_segments(bench_cable(), static_cast<int>(n)));
  };
  study.series("segments", "equilibrium of a cable", "segments", sizes, [&](double n) {
    const auto scene = cable(n);
    return Case{[scene] { (void)model::prepare_motions(*scene, {}); }, scene};
  });
  study.series("segments", "equilibrium and first 6 modes", "segments", sizes, [&](double n) {
    const auto scene = cable(n);
    return Case{[scene] { (void)model::find_modes(*scene, first_modes(6)); }, scene};
  });
  study.series("segments", "frequency response, 100 lines", "segments", sizes, [&](double n) {
    const auto scene = cable(n);
    scene->members[0].damping_ratio.reset();
    scene->members[0].damping.bending = 1e-3;
    return Case{
        [scene] { (void)model::synthesize_frfs(*scene, Eigen::VectorXd::LinSpaced(100, 0.5, 50)); },
        scene};
  });
}

void by_poles(Study& study) {
  const std::vector<double> sizes{1, 2, 5, 12, 25, 50, 100};
  study.series("poles", "equilibrium of a line", "poles", sizes, [](double n) {
    const auto line = std::make_shared<model::Scene>(utility_line(static_cast<int>(n), 60, 20));
    return Case{[line] { (void)model::prepare_motions(*line, {}); }, line};
  });
  study.series("poles", "equilibrium and first 50 modes of a line", "poles", sizes, [](double n) {
    const auto line = std::make_shared<model::Scene>(utility_line(static_cast<int>(n), 60, 20));
    return Case{[line] { (void)model::find_modes(*line, first_modes(50)); }, line};
  });
}

void by_channels(Study& study) {
  const std::vector<double> sizes{1, 5, 20, 100, 500};
  constexpr Index kBlock = 8192;
  study.series("channels", "H1 of 5 hits of 8192 samples", "channels", sizes, [](double n) {
    const auto channels = static_cast<Index>(n);
    struct Data {
      std::vector<Eigen::MatrixXd> records;
      std::vector<signal::FrfBlock> blocks;
    };
    const auto data = std::make_shared<Data>();
    const SampledStructure structure(TenModes(channels), 4096);
    for (int k = 0; k < 5; ++k) {
      data->records.push_back(
          structure.hit(kBlock, 40, 4, 100, 0.005, static_cast<std::uint64_t>(k + 1)));
    }
    for (const auto& record : data->records) {
      signal::FrfBlock block;
      for (Index c = 0; c <= channels; ++c) {
        const std::span<const double> view(record.col(c).data(), std::size_t(kBlock));
        if (c == 0) {
          block.force = view;
        } else {
          block.responses.push_back(view);
        }
      }
      data->blocks.push_back(std::move(block));
    }
    return Case{[data] {
                  signal::FrfOptions options;
                  options.sample_rate_hz = 4096;
                  options.block_samples = kBlock;
                  (void)signal::average_frfs(data->blocks, options);
                },
                data};
  });
  const auto functions = [](double n) {
    return std::make_shared<signal::FrfSet>(
        TenModes(static_cast<Index>(n)).frfs(Eigen::VectorXd::LinSpaced(1400, 1, 1400), 1e-3, 1));
  };
  study.series("channels", "poles of orders to 60, 1400 lines", "channels", sizes, [&](double n) {
    const auto set = functions(n);
    return Case{[set] { (void)signal::lscf(set->frequency_hz, set->H, 1); }, set};
  });
  study.series("channels", "modes found and refined, 1400 lines", "channels", sizes, [&](double n) {
    const auto set = functions(n);
    return Case{[set] { (void)signal::identify_modes(*set); }, set};
  });
}

/// A decay of 50 Hz at 1 kHz over the whole record, 40 dB.
std::shared_ptr<signal::Recording> decay_record(double size) {
  const auto recording = std::make_shared<signal::Recording>();
  recording->sample_rate_hz = 1000;
  recording->channels.resize(1);
  signal::Channel& channel = recording->channels[0];
  channel.name = "a";
  channel.samples.resize(static_cast<Index>(size));
  std::mt19937_64 random(1);
  std::normal_distribution<double> normal(0, 0.007);
  const double w = 2 * std::numbers::pi * 0.05, rate = 6 / size;
  const std::complex<double> turn = std::polar(std::exp(-rate), w);
  std::complex<double> z = 1;
  for (double& value : channel.samples) {
    value = z.real() + normal(random);
    z *= turn;
  }
  return recording;
}

void by_samples(Study& study) {
  const auto sizes = whole_decades(1e4, 1e8);
  study.series("samples", "decay found and fitted", "samples", sizes, [](double n) {
    const auto record = decay_record(n);
    return Case{[record] { (void)signal::estimate_decay(record->channels[0].samples, 1000); },
                record};
  });
  study.series("samples", "quality of a channel", "samples", sizes, [](double n) {
    const auto record = decay_record(n);
    return Case{[record] { (void)signal::check_quality(*record); }, record};
  });
}

/// A file of a folder of its own, gone with the object.
class TemporaryFile {
 public:
  explicit TemporaryFile(const char* name) {
    std::string pattern = (fs::temp_directory_path() / "rigfit-bench-XXXXXX").string();
    if (!::mkdtemp(pattern.data())) throw std::runtime_error("cannot make " + pattern);
    folder_ = pattern;
    path = folder_ / name;
  }
  ~TemporaryFile() {
    std::error_code error;
    fs::remove_all(folder_, error);
  }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;
  fs::path path;

 private:
  fs::path folder_;
};

void by_file(Study& study) {
  study.series(
      "files", "CSV read, 6 channels", "bytes of file", {1e6, 1e7, 1e8, 1e9, 4e9}, [](double size) {
        const auto file = std::make_shared<TemporaryFile>("record.csv");
        std::string block;
        for (int k = 0; k < 4000; ++k) {
          for (int c = 0; c < 6; ++c) {
            block +=
                fmt::format("{}{:.9g}", c > 0 ? "," : "", 10 * std::sin(0.001 * (k + 1) * (c + 1)));
          }
          block += '\n';
        }
        std::ofstream out(file->path, std::ios::binary);
        out << "sample_rate_hz,51200\na,b,c,d,e,f\n";
        for (double written = 0; written < size; written += double(block.size())) {
          out << block;
        }
        out.close();
        if (!out) throw std::runtime_error("cannot write " + file->path.string());
        return Case{[file] { (void)signal::read_recording(file->path); }, file};
      });
}

}  // namespace

double log_slope(const std::vector<double>& x, const std::vector<double>& y) {
  const auto n = static_cast<double>(x.size());
  double sx = 0, sy = 0, sxx = 0, sxy = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double a = std::log(x[i]), b = std::log(y[i]);
    sx += a, sy += b, sxx += a * a, sxy += a * b;
  }
  return (n * sxy - sx * sy) / (n * sxx - sx * sx);
}

const std::vector<std::string>& size_tasks() {
  static const std::vector<std::string> tasks{"segments", "poles", "channels", "samples", "files"};
  return tasks;
}

void run_size_study(const SizeLimits& limits, const std::vector<std::string>& tasks,
                    const std::function<void(const SizeSeries&)>& done) {
  Study study(limits, done);
  const auto wanted = [&](const std::string& task) {
    return tasks.empty() || std::find(tasks.begin(), tasks.end(), task) != tasks.end();
  };
  if (wanted("segments")) by_segments(study);
  if (wanted("poles")) by_poles(study);
  if (wanted("channels")) by_channels(study);
  if (wanted("samples")) by_samples(study);
  if (wanted("files")) by_file(study);
}

}  // namespace rigfit::apps
