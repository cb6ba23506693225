// Colours of figures: told apart by everyone, readable on their paper. Colour blindness is
// simulated by the matrices of Machado, Oliveira and Fernandes (2009), severity 1, on linear sRGB;
// distances are Euclidean in CIELAB (D65).
#include "apps/report/drawing/palette.h"

#include "tests/test.h"

namespace rigfit::apps::palette_test {

using Eigen::Matrix3d;
using Eigen::Vector3d;

Vector3d linear(const std::string& colour) {
  Vector3d rgb;
  for (int k = 0; k < 3; ++k) {
    const double c =
        std::stoi(colour.substr(1 + 2 * static_cast<std::size_t>(k), 2), nullptr, 16) / 255.0;
    rgb[k] = c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
  }
  return rgb;
}

double luminance(const std::string& colour) {
  return linear(colour).dot(Vector3d(0.2126729, 0.7151522, 0.0721750));
}

double contrast(const std::string& a, const std::string& b) {
  const double x = luminance(a), y = luminance(b);
  return (std::max(x, y) + 0.05) / (std::min(x, y) + 0.05);
}

Vector3d lab(const Vector3d& rgb) {
  Matrix3d to_xyz;
  to_xyz << 0.4124564, 0.3575761, 0.1804375, 0.2126729, 0.7151522, 0.0721750, 0.0193339, 0.1191920,
      0.9503041;
  const Vector3d xyz = to_xyz * rgb.cwiseMax(0).cwiseMin(1), white(0.95047, 1, 1.08883);
  Vector3d f;
  for (int k = 0; k < 3; ++k) {
    const double t = xyz[k] / white[k];
    f[k] = t > 216.0 / 24389 ? std::cbrt(t) : (24389.0 / 27 * t + 16) / 116;
  }
  return {116 * f[1] - 16, 500 * (f[0] - f[1]), 200 * (f[1] - f[2])};
}

std::vector<Matrix3d> visions() {
  Matrix3d deuteranopia, protanopia;
  deuteranopia << 0.367322, 0.860646, -0.227968, 0.280085, 0.672501, 0.047413, -0.011820, 0.042940,
      0.968881;
  protanopia << 0.152286, 1.052583, -0.204868, 0.114503, 0.786281, 0.099216, -0.003882, -0.048116,
      1.051998;
  return {Matrix3d::Identity(), deuteranopia, protanopia};
}

template <std::size_t N>
void expect_apart(const std::array<Colour, N>& colours) {
  for (const Matrix3d& vision : visions()) {
    for (std::size_t i = 0; i < N; ++i) {
      for (std::size_t j = 0; j < i; ++j) {
        // 20 is about ten times the least difference that is seen side by side (2.3).
        const auto distance = [&](const char* a, const char* b) {
          return (lab(vision * linear(a)) - lab(vision * linear(b))).norm();
        };
        EXPECT_GT(distance(colours[i].on_light, colours[j].on_light), 20) << i << ' ' << j;
        EXPECT_GT(distance(colours[i].on_dark, colours[j].on_dark), 20) << i << ' ' << j;
      }
    }
  }
}

// Three sensors are three colours.
TEST(Palette, OriginsAndSeriesStayApartForEveryReader) {
  expect_apart(kOriginColours);
  expect_apart(kSeriesColours);
}

TEST(Palette, EveryColourIsReadableOnItsPaper) {
  for (const auto& one : kOriginColours) {
    EXPECT_GE(contrast(one.on_light, "#ffffff"), 4.5) << one.on_light;
    EXPECT_GE(contrast(one.on_dark, kDarkPaper), 4.5) << one.on_dark;
  }
  for (const auto& one : kSeriesColours) {
    EXPECT_GE(contrast(one.on_light, "#ffffff"), 3) << one.on_light;
    EXPECT_GE(contrast(one.on_dark, kDarkPaper), 3) << one.on_dark;
  }
}

}  // namespace rigfit::apps::palette_test
