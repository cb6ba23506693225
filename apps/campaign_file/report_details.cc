#include "apps/campaign_file/report_details.h"

#include <openssl/evp.h>

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
  std::string text(4 * ((bytes.size() + 2) / 3) + 1, '\0');  // EVP ends with a zero
  const auto* from = reinterpret_cast<const unsigned char*>(bytes.data());
  const int length = EVP_EncodeBlock(reinterpret_cast<unsigned char*>(text.data()), from,
                                     static_cast<int>(bytes.size()));
  text.resize(static_cast<std::size_t>(length));
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
