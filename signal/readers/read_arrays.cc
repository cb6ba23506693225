#include "signal/readers/csv_table.h"

#include <fmt/ranges.h>
#include <sndfile.h>

#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <regex>

#include "signal/readers/read_recording.h"
#include "signal/recording/recording_time.h"

namespace rigfit::signal {
namespace {

/// What the dictionary says that numpy.save writes: {'descr': '<f8', 'fortran_order': False,
/// 'shape': (3, 2), }.
struct Header {
  NumberType type;
  bool by_rows = true;
  std::vector<double> shape;
};

Header parse_header(const std::string& text, const std::string& file) {
  static const std::regex kHeader(
      R"(\{\s*'descr'\s*:\s*'([<>|=])([fiub])([1248])'\s*,)"
      R"(\s*'fortran_order'\s*:\s*(True|False)\s*,\s*'shape'\s*:\s*\(([0-9, ]*)\))"),
      kSize("[0-9]+");
  std::smatch found;
  if (!std::regex_search(text, found, kHeader, std::regex_constants::match_continuous)) {
    throw file_error(file,
                     "holds no plain numbers (but records, complex numbers or Python objects), or "
                     "its header is damaged",
                     "save an array of numbers with numpy.save", to_utf8(text.substr(0, 60)));
  }
  Header header{
      {*found[2].first == 'b' ? 'u' : *found[2].first,
       static_cast<std::size_t>(*found[3].first - '0'), found[1] == (is_swapped(true) ? ">" : "<")},
      found[4] == "False",
      {}};
  const std::string sizes = found[5];
  for (std::sregex_iterator one(sizes.begin(), sizes.end(), kSize), end; one != end; ++one) {
    header.shape.push_back(std::strtod(one->str().c_str(), nullptr));
  }
  return header;
}

}  // namespace

MatrixXd matrix_of(const NumberType& type, const char* bytes, Index rows, Index cols,
                   bool by_rows) {
  MatrixXd numbers;
  const auto take = [&](char kind, auto number) {
    if (type.kind != kind || type.size != sizeof number) return;
    numbers.resize(rows, cols);
    const Index length = by_rows ? cols : rows;
    std::array<char, sizeof number> one{};
    for (Index run = 0; run < (by_rows ? rows : cols); ++run) {
      for (Index k = 0; k < length; ++k, bytes += sizeof number) {
        std::memcpy(one.data(), bytes, sizeof number);
        if (type.swapped) std::ranges::reverse(one);
        numbers.data()[by_rows ? k * rows + run : run * rows + k] =
            static_cast<double>(std::bit_cast<decltype(number)>(one));
      }
    }
  };
  const auto each = [&](char kind, auto... one) { (take(kind, one), ...); };
  each('f', float{}, double{});
  each('i', std::int8_t{}, std::int16_t{}, std::int32_t{}, std::int64_t{});
  each('u', std::uint8_t{}, std::uint16_t{}, std::uint32_t{}, std::uint64_t{});
  return numbers;
}

void add_array(const MatrixXd& values, const std::string& name, bool single, CsvTable& table) {
  const bool wide = values.cols() > values.rows();
  const Index count = wide ? values.rows() : values.cols();
  if (wide && count > 1) {
    add_note(table.notes, "read_as", name, "an array of {} x {}: its rows are taken as channels",
             values.rows(), values.cols());
  }
  for (Index k = 0; k < count; ++k) {
    VectorXd numbers = wide ? VectorXd(values.row(k)) : values.col(k);
    const std::size_t place = table.channels.size();
    const std::string own = name.empty() ? "column " + std::to_string(place + 1)
                                         : (count == 1 ? name : name + " " + std::to_string(k + 1));
    TitledUnit titled = split_title(to_utf8(own));
    CsvColumn column{std::move(titled.name), std::move(titled.unit)};
    const double largest = numbers.array().isFinite().select(numbers.array().abs(), 0).maxCoeff();
    if (single && largest > 0) {
      column.decimals = -static_cast<int>(std::ceil(std::log10(6e-8 * largest)));
    }
    column.place = place;
    table.add(std::move(column), std::move(numbers));
  }
}

Recording recording_of_arrays(CsvTable table, const std::filesystem::path& path,
                              const std::string& format, const ReadOptions& options,
                              double stated_rate_hz) {
  table.file = path.string();
  table.layout.stated_rate_hz = stated_rate_hz;
  table.layout.rate_text = "in the file";
  table.layout.body_line = 0;
  table.layout.has_names = true;
  CsvColumn& first = table.columns.front();
  if (table.columns.size() > 1 && stated_rate_hz == 0 &&
      looks_like_time(table.channels.front().samples, first.decimals) &&
      std::ranges::none_of(table.columns, [](const auto& c) { return is_time_name(c.name); })) {
    add_note(table.notes, "read_as", first.name, "rises in equal steps: taken as time in seconds");
    table.channels.front().name = first.name = "time";
  }
  return recording_of_table(std::move(table), path, format, options);
}

Recording read_npy(std::string_view bytes, const std::filesystem::path& path,
                   const ReadOptions& options) {
  const std::string file = path.string();
  if (bytes.size() < 12 || bytes.substr(0, 6) != "\x93NUMPY") {
    throw file_error(file, "is no NumPy array", "save it with numpy.save");
  }
  const std::size_t begin = static_cast<unsigned char>(bytes[6]) >= 2 ? 12 : 10;  // by version
  const auto length = static_cast<std::size_t>(
      matrix_of({'u', begin - 8, is_swapped(false)}, bytes.data() + 8, 1, 1)(0, 0));
  if (length > bytes.size() - begin) {
    throw file_error(file, "breaks off inside its header", "copy the file again");
  }
  constexpr std::size_t kLongestHeader = 1 << 13;  // enough for a hundred named fields
  const std::string dictionary(bytes.substr(begin, std::min(length, kLongestHeader)));
  const Header header = parse_header(dictionary, file);
  const std::string_view data = bytes.substr(begin + length);
  const std::size_t item = header.type.size;
  double items = 1;
  for (const double n : header.shape) items *= n;
  if (items == 0 || header.shape.empty()) {
    throw file_error(file, "holds no samples", "record again");
  }
  const std::string shape = fmt::format("{}", fmt::join(header.shape, " x "));
  if (items * static_cast<double>(item) != static_cast<double>(data.size())) {
    throw file_error(file,
                     fmt::format("states an array of {}, {} bytes each, but holds {} bytes", shape,
                                 item, data.size()),
                     "copy the file again");
  }
  if (header.shape.size() > 2) {
    throw file_error(file, "holds an array of " + shape,
                     "save one with samples and channels only (two dimensions)");
  }
  const auto rows = static_cast<Index>(header.shape[0]);
  const auto cols = static_cast<Index>(header.shape.size() > 1 ? header.shape[1] : 1);
  MatrixXd values = matrix_of(header.type, data.data(), rows, cols, header.by_rows);
  if (values.size() == 0) {
    throw file_error(file, "holds numbers of half precision, which are not read",
                     "save them as float32 or float64");
  }
  if (options.done_with) options.done_with(bytes.size());
  CsvTable table;
  add_array(values, "", header.type.kind == 'f' && item == 4, table);
  return recording_of_arrays(std::move(table), path, "npy", options, 0);
}

Recording read_wav(std::string_view bytes, const std::filesystem::path& path,
                   const ReadOptions& options) {
  SF_INFO info{};
  const std::unique_ptr<SNDFILE, int (*)(SNDFILE*)> file(sf_open(path.c_str(), SFM_READ, &info),
                                                         &sf_close);
  if (!file) {
    throw file_error(path, std::string("is no WAV file that can be read: ") + sf_strerror(nullptr),
                     "save it again as PCM or floating point WAV");
  }
  const int coding = info.format & SF_FORMAT_SUBMASK;
  const bool whole = coding <= SF_FORMAT_PCM_U8;  // then come the two of floating point
  if (coding > SF_FORMAT_DOUBLE) {
    throw file_error(path, "holds compressed sound",
                     "save it as PCM or floating point WAV, which keeps the signal");
  }
  // Every sample takes a byte at least.
  const auto held = static_cast<sf_count_t>(bytes.size()) / info.channels;
  MatrixXd data(info.channels, std::clamp<sf_count_t>(info.frames, 0, held));
  const auto frames = static_cast<Index>(sf_readf_double(file.get(), data.data(), data.cols()));
  if (frames <= 0) throw file_error(path, "holds no samples", "record again");

  CsvTable table;
  // Parts of their stated sizes follow each other up to the end of the file; a recorder that wrote
  // to a pipe states the largest size.
  std::size_t end = 12;
  while (bytes.starts_with("RIFF") && end + 8 <= bytes.size()) {
    const auto stated = static_cast<std::size_t>(
        matrix_of({'u', 4, is_swapped(false)}, bytes.data() + end + 4, 1, 1)(0, 0));
    end = stated >= 0xFFFFFF00U ? bytes.size() : end + 8 + stated + stated % 2;
  }
  if (bytes.starts_with("RIFF") && end != bytes.size() && end != bytes.size() + bytes.size() % 2) {
    add_note(table.notes, "incomplete", "",
             "the file states {} bytes and holds {}: cut short, or samples behind those stated are "
             "left out",
             end, bytes.size());
  }
  for (Index c = 0; c < data.rows(); ++c) {
    add_array(data.row(c).head(frames).transpose(), fmt::format("channel {}", c + 1), false, table);
  }
  Recording recording =
      recording_of_arrays(std::move(table), path, "wav", options, info.samplerate);
  for (auto& channel : recording.channels) channel.nominal_range = whole ? 1 : 0;
  if (whole) {
    recording.notes.back().message =
        "samples are fractions of full scale: give scale and unit for physical values";
  }
  return recording;
}

}  // namespace rigfit::signal
