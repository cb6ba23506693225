#include "apps/cli/sha256.h"

#include <fmt/format.h>
#include <openssl/evp.h>

#include <array>
#include <cerrno>
#include <fstream>
#include <memory>
#include <new>
#include <system_error>
#include <vector>

namespace rigfit::apps {
namespace {

class Hash {
 public:
  Hash() : digest_(EVP_MD_CTX_new(), &EVP_MD_CTX_free) {
    if (!digest_ || EVP_DigestInit_ex(digest_.get(), EVP_sha256(), nullptr) != 1) {
      throw std::bad_alloc();
    }
  }
  void add(const char* data, std::size_t size) { EVP_DigestUpdate(digest_.get(), data, size); }
  std::string finish() {
    std::array<unsigned char, EVP_MAX_MD_SIZE> bytes{};
    unsigned size = 0;
    EVP_DigestFinal_ex(digest_.get(), bytes.data(), &size);
    std::string hex;
    for (unsigned k = 0; k < size; ++k) hex += fmt::format("{:02x}", bytes[k]);
    return hex;
  }

 private:
  std::unique_ptr<EVP_MD_CTX, void (*)(EVP_MD_CTX*)> digest_;
};

}  // namespace

std::string sha256(std::string_view bytes) {
  Hash hash;
  hash.add(bytes.data(), bytes.size());
  return hash.finish();
}

std::string sha256_of_file(const std::filesystem::path& path) {
  const auto fail = [&](int reason) {
    throw std::system_error(reason, std::generic_category(), "cannot read " + path.string());
  };
  // A device or a pipe may have no end.
  if (!std::filesystem::is_regular_file(path)) fail(EINVAL);
  std::ifstream file(path, std::ios::binary);
  if (!file) fail(errno);
  Hash hash;
  std::vector<char> buffer(1 << 16);
  while (file.read(buffer.data(), static_cast<std::streamsize>(buffer.size())) ||
         file.gcount() > 0) {
    hash.add(buffer.data(), static_cast<std::size_t>(file.gcount()));
  }
  return hash.finish();
}

}  // namespace rigfit::apps
