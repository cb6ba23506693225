// WAV, NumPy and MATLAB files as their programs write them, damaged ones, and formats that are
// named and refused.
#include <matio.h>

#include <cstdint>

#include "signal/readers/read_recording.h"
#include "tests/signal/readers/reading.h"
#include "tests/temporary_folder.h"
#include "tests/test.h"

namespace rigfit::signal::arrays_test {

namespace fs = std::filesystem;

std::string little(std::uint64_t value, int bytes) {
  std::string out;
  for (int k = 0; k < bytes; ++k) out += static_cast<char>(value >> (8 * k) & 0xFF);
  return out;
}

std::string wav(int format, int bits, int channels, const std::string& data) {
  const int block = channels * bits / 8;
  const std::string fmt_chunk = little(static_cast<std::uint64_t>(format), 2) +
                                little(static_cast<std::uint64_t>(channels), 2) + little(2048, 4) +
                                little(static_cast<std::uint64_t>(2048 * block), 4) +
                                little(static_cast<std::uint64_t>(block), 2) +
                                little(static_cast<std::uint64_t>(bits), 2);
  return "RIFF" + little(36 + data.size(), 4) + "WAVEfmt " + little(16, 4) + fmt_chunk + "data" +
         little(data.size(), 4) + data;
}

/// Puts the bytes into a file, which libsndfile reads.
Recording read_sound(const std::string& bytes) {
  const testing::TemporaryFolder folder;
  return read_wav(bytes, folder.write("sound.wav", bytes));
}

double wanted(int k) { return 0.5 * std::sin(0.1 * k); }

TEST(Wav, OfEveryWidthGivesTheSameSamples) {
  for (const int bits : {8, 16, 24, 32}) {
    std::string data;
    const double full = std::ldexp(1.0, bits - 1);
    for (int k = 0; k < 300; ++k) {
      const auto whole = static_cast<std::int64_t>(std::lround(wanted(k) * full));
      data += little(static_cast<std::uint64_t>(bits == 8 ? whole + 128 : whole), bits / 8);
    }
    const auto recording = read_sound(wav(1, bits, 1, data));
    EXPECT_EQ(recording.sample_rate_hz, 2048);
    ASSERT_EQ(recording.samples(), 300) << bits;
    EXPECT_EQ(recording.channels[0].nominal_range, 1);
    // Half a step of the converter.
    for (int k = 0; k < 300; ++k) {
      EXPECT_NEAR(recording.channels[0].samples[k], wanted(k), 0.51 / full) << bits;
    }
  }
  for (const int bits : {32, 64}) {
    std::string data;
    for (int k = 0; k < 300; ++k) {
      const double x = wanted(k);
      const auto single = static_cast<float>(x);
      data.append(
          bits == 64 ? reinterpret_cast<const char*>(&x) : reinterpret_cast<const char*>(&single),
          static_cast<std::size_t>(bits / 8));
    }
    const auto recording = read_sound(wav(3, bits, 2, data));
    ASSERT_EQ(recording.channels.size(), 2u);
    ASSERT_EQ(recording.samples(), 150);
    EXPECT_NEAR(recording.channels[1].samples[7], wanted(15), 1e-7);
  }
}

TEST(Wav, CutShortIsReadAsFarAsItGoesAndSaid) {
  const std::string whole = wav(1, 16, 1, std::string(2000, '\1'));
  const auto recording = read_sound(whole.substr(0, 1044));
  EXPECT_EQ(recording.samples(), 500);
  EXPECT_TRUE(says(recording.notes, "incomplete"));
  EXPECT_THAT(refusal_of([&] { return read_sound(whole.substr(0, 20)); }), HasSubstr("WAV"));
  // Samples behind those that the file states; a part of another kind is none.
  EXPECT_TRUE(says(read_sound(whole + "samples behind").notes, "incomplete"));
  EXPECT_FALSE(says(read_sound(whole + "LIST" + little(4, 4) + "INFO").notes, "incomplete"));
}

std::string npy(const std::string& header, const std::string& data) {
  std::string text = header + std::string(64 - (10 + header.size() + 1) % 64, ' ') + "\n";
  return std::string("\x93NUMPY\x01\x00", 8) + little(text.size(), 2) + text + data;
}

template <typename Number>
std::string bytes_of(const std::vector<Number>& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(Number)};
}

TEST(Npy, ArraysOfSamplesAndChannelsAreRead) {
  std::vector<double> values;
  for (int k = 0; k < 40; ++k) values.insert(values.end(), {0.001 * k, 1.0 * k * k});
  for (const char* layout : {"False, 'shape': (40, 2)", "True, 'shape': (2, 40)"}) {
    const auto read = read_npy(
        npy(fmt::format("{{'descr': '<f8', 'fortran_order': {}, }}", layout), bytes_of(values)),
        "a.npy");
    ASSERT_EQ(read.channels.size(), 1u);
    EXPECT_NEAR(read.sample_rate_hz, 1000, 1e-9);
    EXPECT_TRUE(says(read.notes, "read_as"));
    EXPECT_EQ(read.channels[0].samples[5], 25);
  }
  const auto whole = read_npy(npy("{'descr': '>i2', 'fortran_order': False, 'shape': (3,), }",
                                  std::string("\x00\x01\xFF\xFE\x01\x00", 6)),
                              "a.npy");
  EXPECT_EQ(whole.channels[0].samples, Eigen::Vector3d(1, -2, 256));
}

TEST(Npy, WhatCannotBeReadIsSaid) {
  for (const auto& [type, shape, said] : {std::tuple{"'|O'", "(1,)", "Python objects"},
                                          {"[('t', '<f8')]", "(1,)", "records"},
                                          {"'<c16'", "(1,)", "complex"},
                                          {"'<f8'", "(99999999999, 99999999999)", "holds 8 bytes"},
                                          {"'<f8'", "(1, 1, 1)", "1 x 1 x 1"},
                                          {"'<i4'", "(1,)", "holds 8 bytes"},
                                          {"'<f8'", "(0,)", "no samples"}}) {
    const std::string header =
        fmt::format("{{'descr': {}, 'fortran_order': False, 'shape': {}, }}", type, shape);
    const std::string data = std::string(shape) == "(0,)" ? "" : "12345678";
    EXPECT_THAT(refusal_of([&] { return read_npy(npy(header, data), "a.npy"); }), HasSubstr(said));
  }
}

/// A .mat file of this test's own.
class Mat : public ::testing::Test {
 protected:
  static matvar_t* array(const char* name, std::vector<double> values, std::size_t rows,
                         std::size_t cols) {
    std::size_t dims[2] = {rows, cols};
    return Mat_VarCreate(name, MAT_C_DOUBLE, MAT_T_DOUBLE, 2, dims, values.data(), 0);
  }
  void write(const std::vector<matvar_t*>& variables, mat_ft version = MAT_FT_MAT5,
             matio_compression compression = MAT_COMPRESSION_ZLIB) {
    mat_t* const file = Mat_CreateVer(path_.c_str(), nullptr, version);
    ASSERT_NE(file, nullptr);
    for (auto* variable : variables) {
      EXPECT_EQ(Mat_VarWrite(file, variable, compression), 0);
      Mat_VarFree(variable);
    }
    Mat_Close(file);
  }
  std::string content() const { return folder_.read(path_.filename()); }

  Recording read(const fs::path& path, const ReadOptions& options = {}) const {
    return read_mat(content(), path, options);
  }

  testing::TemporaryFolder folder_;
  const fs::path path_ = folder_.path() / "\xC3\xA4.mat";
};

std::vector<double> ramp(int n, double step) {
  std::vector<double> values;
  for (int k = 0; k < n; ++k) values.push_back(step * k);
  return values;
}

TEST_F(Mat, ArraysOfOneLengthWithARateOrATime) {
  for (const auto version : {MAT_FT_MAT5, MAT_FT_MAT73}) {
    write({array("acc", ramp(80, 0.5), 40, 2), array("force", ramp(40, 1), 1, 40),
           array("fs", {2000}, 1, 1)},
          version);
    const auto recording = read_recording(path_);
    EXPECT_EQ(recording.format, "mat");
    EXPECT_EQ(recording.sample_rate_hz, 2000);
    ASSERT_EQ(recording.channels.size(), 3u);
    EXPECT_EQ(recording.channel("acc 2").samples[0], 20);
    EXPECT_EQ(recording.channel("force").samples[3], 3);
    fs::resize_file(path_, fs::file_size(path_) / 2);
    EXPECT_THAT(refusal_of([&] { return read(path_); }), HasSubstr("breaks off"));
    fs::remove(path_);
  }
  write({array("t", ramp(40, 0.001), 40, 1), array("x", ramp(40, 2), 40, 1)});
  EXPECT_NEAR(read(path_).sample_rate_hz, 1000, 1e-9);
}

TEST_F(Mat, SamplesGetTheTimesOfTheirOwnStructure) {
  const auto run = [&](const char* name, double step) {
    const char* names[] = {"t", "acc"};
    std::size_t one[2] = {1, 1};
    matvar_t* const made = Mat_VarCreateStruct(name, 2, one, names, 2);
    Mat_VarSetStructFieldByName(made, "t", 0, array("t", ramp(40, step), 40, 1));
    Mat_VarSetStructFieldByName(made, "acc", 0, array("acc", ramp(40, 3), 40, 1));
    return made;
  };
  write({run("first", 0.01), run("second", 0.002)});
  EXPECT_THAT(refusal_of([&] { return read(path_); }), HasSubstr("--variable second.acc"));
  for (const auto& [name, rate] :
       {std::pair<const char*, double>{"first.acc", 100}, {"second.acc", 500}}) {
    const auto recording = read(path_, {.variables = {name}});
    EXPECT_NEAR(recording.sample_rate_hz, rate, 1e-9);
    EXPECT_EQ(recording.channels[0].name, name);
  }
}

TEST_F(Mat, TestlabStatesItsAxis) {
  const auto made = [](const char* name, std::vector<matvar_t*> fields) {
    std::vector<const char*> names;
    for (const auto* field : fields) names.push_back(field->name);
    std::size_t one[2] = {1, 1};
    matvar_t* const of = Mat_VarCreateStruct(name, 2, one, names.data(), unsigned(names.size()));
    for (auto* field : fields) Mat_VarSetStructFieldByName(of, field->name, 0, field);
    return of;
  };
  write({made("Signal", {made("x_values",
                              {array("start_value", {0}, 1, 1), array("increment", {0.01}, 1, 1)}),
                         made("y_values", {array("values", ramp(40, 1), 40, 1)})})});
  EXPECT_NEAR(read(path_).sample_rate_hz, 100, 1e-9);
}

TEST_F(Mat, CutShortIsRefused) {
  write({array("acc", ramp(400, 0.5), 400, 1), array("fs", {2000}, 1, 1)});
  fs::resize_file(path_, fs::file_size(path_) - 40);
  EXPECT_THAT(refusal_of([&] { return read(path_); }), HasSubstr("breaks off"));
}

TEST_F(Mat, SeveralLengthsAreAskedAbout) {
  write({array("long_one", ramp(100, 1), 100, 1), array("short_one", ramp(50, 1), 50, 1)});
  EXPECT_THAT(
      refusal_of([&] { return read(path_); }),
      AllOf(HasSubstr("\"long_one (100 x 1)\", \"short_one (50 x 1)\""), HasSubstr("--variable")));
  const auto recording = read(path_, {.variables = {"short_one"}});
  EXPECT_EQ(recording.samples(), 50);
  EXPECT_TRUE(says(recording.notes, "left_out"));
}

TEST_F(Mat, FrfsAreComplexArraysOverFrequencies) {
  std::vector<double> real = ramp(60, 1), imaginary = ramp(60, -1);
  mat_complex_split_t split{real.data(), imaginary.data()};
  std::size_t dims[2] = {30, 2};
  write({Mat_VarCreate("H", MAT_C_DOUBLE, MAT_T_DOUBLE, 2, dims, &split, MAT_F_COMPLEX),
         array("freq", ramp(30, 0.5), 30, 1)});
  const FrfSet set = read_mat_frfs(content(), path_);
  ASSERT_EQ(set.H.rows(), 30);
  ASSERT_EQ(set.H.cols(), 2);
  EXPECT_EQ(set.H(2, 1), Complex(32, -32));
  EXPECT_EQ(set.frequency_hz[2], 1);
  EXPECT_THAT(refusal_of([&] { return read(path_); }), HasSubstr("freq"));
  // Without them by the rate and the block length of the FFT: 30 lines are 58 / 2 + 1.
  for (const double length : {57, 58}) {
    write({Mat_VarCreate("yspec", MAT_C_DOUBLE, MAT_T_DOUBLE, 2, dims, &split, MAT_F_COMPLEX),
           array("freq", {1160}, 1, 1), array("npts", {length}, 1, 1)});
    if (length == 58) break;
    EXPECT_THAT(refusal_of([&] { return read_mat_frfs(content(), path_); }), HasSubstr("freq"));
  }
  EXPECT_NEAR(read_mat_frfs(content(), path_).frequency_hz[29], 580, 1e-9);
}

TEST_F(Mat, ArraysThatStateOtherSizesThanTheyHoldAreRefused) {
  write({array("acc", ramp(40, 0.5), 40, 1), array("fs", {2000}, 1, 1)}, MAT_FT_MAT5,
        MAT_COMPRESSION_NONE);
  const std::string whole = content(), size = little(40, 4) + little(1, 4);
  for (const std::uint64_t rows : {39ULL, 48ULL}) {
    std::string bytes = whole;
    bytes.replace(bytes.find(size), 4, little(rows, 4));
    std::ofstream(path_, std::ios::binary) << bytes;
    EXPECT_THAT(refusal_of([&] { return read(path_); }), HasSubstr("than it can hold")) << rows;
  }
}

TEST_F(Mat, StructsThatStateMoreThanTheFileHoldsAreRefused) {
  const std::string version = std::string("\0\1IM", 4);
  const auto part = [](std::uint64_t type, const std::string& data) {
    const std::string padding((8 - data.size() % 8) % 8, '\0');
    return little(type, 4) + little(data.size(), 4) + data + padding;
  };
  const auto file = [&](std::uint64_t elements) {
    const std::string inside = part(6, little(2, 4) + little(0, 4)) +
                               part(5, little(1, 4) + little(elements, 4)) + part(1, "run") +
                               part(5, little(2, 4)) + part(1, std::string("x\0", 2)) +
                               little(14, 4) + little(0, 4);
    return std::string(124, ' ') + version + little(14, 4) + little(inside.size(), 4) + inside;
  };
  for (const std::uint64_t elements : {2ULL, 1ULL << 30}) {
    std::ofstream(path_, std::ios::binary) << file(elements);
    EXPECT_THAT(refusal_of([&] { return read(path_); }), HasSubstr("can hold"));
  }
  std::ofstream(path_, std::ios::binary) << file(1);
  EXPECT_THAT(refusal_of([&] { return read(path_); }), HasSubstr("no array"));
  std::ofstream(path_, std::ios::binary) << std::string(200, '\1');
  EXPECT_THAT(refusal_of([&] { return read(path_); }), HasSubstr("version 5 to 7.3"));
}

TEST(ForeignFormats, AreNamedWithTheWayOut) {
  const testing::TemporaryFolder folder;
  for (const auto& [bytes, name] : {std::pair{"TDSm\x0E", "TDMS"},
                                    {"MDF     4.10    ", "MDF"},
                                    {"\x89HDF\r\n\x1a\n", "HDF5"},
                                    {"PK\x03\x04 data.csv", "zip archive"},
                                    {"\xEF\xBB\xBF\n<!DOCTYPE html>", "web page"},
                                    {"\xD0\xCF\x11\xE0\xA1\xB1\x1A\xE1", ".xls"}}) {
    const std::string path = folder.write("a", bytes);
    EXPECT_THAT(refusal_of([&] { return read_recording(path); }), HasSubstr(name));
  }
}

}  // namespace rigfit::signal::arrays_test
