// SHA-256 (FIPS 180-4) of inputs, for provenance; by OpenSSL's libcrypto.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>

namespace rigfit::apps {

/// 64 lower-case hexadecimal digits.
[[nodiscard]] std::string sha256(std::string_view bytes);
/// `progress`, when given, is told of the bytes taken since it was told last. Throws
/// std::system_error when it is no regular file or cannot be read.
[[nodiscard]] std::string sha256_of_file(const std::filesystem::path& path,
                                         const std::function<void(std::size_t)>& progress = {});

}  // namespace rigfit::apps
