#include "apps/campaign_file/report_details.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <fstream>
#include <iterator>
#include <system_error>

namespace rigfit::apps {
namespace fs = std::filesystem;
namespace {

constexpr std::uintmax_t kLargestLogo = 2'000'000;  // bytes: it is embedded in the page

std::string bytes_of(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// Media type by content; empty: no picture that a browser shows.
std::string media_type(const std::string& bytes) {
  if (bytes.starts_with("\x89PNG\r\n\x1a\n")) return "image/png";
  if (bytes.starts_with("\xff\xd8\xff")) return "image/jpeg";
  if (bytes.substr(0, 4096).find("<svg") != std::string::npos) return "image/svg+xml";
  return {};
}

std::string base64(const std::string& bytes) {
  constexpr std::string_view kDigits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve(4 * (bytes.size() / 3 + 1));
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::array<unsigned, 3> part{0, 0, 0};
    const std::size_t n = std::min<std::size_t>(3, bytes.size() - i);
    for (std::size_t k = 0; k < n; ++k) part[k] = static_cast<unsigned char>(bytes[i + k]);
    const unsigned all = part[0] << 16 | part[1] << 8 | part[2];
    for (std::size_t k = 0; k < 4; ++k) {
      text += k <= n ? kDigits[all >> (18 - 6 * k) & 63U] : '=';
    }
  }
  return text;
}

}  // namespace

void check_logo(const std::string& file, const document::TomlTable& table) {
  std::error_code error;
  if (fs::file_size(file, error) > kLargestLogo || media_type(bytes_of(file)).empty()) {
    throw table.error("logo", file + " is no PNG, JPEG or SVG picture of at most 2 MB",
                      "give a smaller picture or one of these formats");
  }
}

std::string logo_data_uri(const std::string& file) {
  if (file.empty()) return {};
  const std::string bytes = bytes_of(file);
  const std::string type = media_type(bytes);
  return type.empty() ? std::string() : "data:" + type + ";base64," + base64(bytes);
}

}  // namespace rigfit::apps
