// Values to bytes and back, for results kept between runs: doubles bit by bit, so that a result
// read back is the result. Structures say their members once, in a function `archive(a, value)`
// found beside them, which serves both ways. The bytes are for this program on this machine only.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <cstring>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

namespace rigfit::apps {

template <class T>
concept Plain = std::is_arithmetic_v<T> || std::is_enum_v<T>;

class ArchiveWriter {
 public:
  static constexpr bool reading = false;
  template <class... T>
  void operator()(T&... values) {
    (put(values), ...);
  }
  [[nodiscard]] std::string take() { return std::move(bytes_); }

 private:
  void raw(const void* data, std::size_t size) {
    bytes_.append(static_cast<const char*>(data), size);
  }
  void put_size(std::size_t size) {
    const std::uint64_t n = size;
    raw(&n, sizeof n);
  }
  template <Plain T>
  void put(T& value) {
    raw(&value, sizeof value);
  }
  void put(std::string& text) {
    put_size(text.size());
    raw(text.data(), text.size());
  }
  void put(nlohmann::ordered_json& json) {
    const auto packed = nlohmann::ordered_json::to_msgpack(json);
    put_size(packed.size());
    raw(packed.data(), packed.size());
  }
  template <class T>
  void put(std::vector<T>& list) {
    put_size(list.size());
    if constexpr (Plain<T> && !std::is_same_v<T, bool>) {
      raw(list.data(), list.size() * sizeof(T));
    } else {
      for (auto& value : list) put(value);
    }
  }
  template <class T>
  void put(std::optional<T>& value) {
    bool there = value.has_value();
    put(there);
    if (there) put(*value);
  }
  template <class A, class B>
  void put(std::pair<A, B>& value) {
    put(value.first);
    put(value.second);
  }
  template <class K, class V>
  void put(std::map<K, V>& map) {
    put_size(map.size());
    for (auto& [key, value] : map) {
      put(const_cast<K&>(key));
      put(value);
    }
  }
  template <class... T>
  void put(std::variant<T...>& value) {
    put_size(value.index());
    std::visit([this](auto& v) { put(v); }, value);
  }
  template <class S, int R, int C>
  void put(Eigen::Matrix<S, R, C>& matrix) {
    put_size(static_cast<std::size_t>(matrix.rows()));
    put_size(static_cast<std::size_t>(matrix.cols()));
    raw(matrix.data(), static_cast<std::size_t>(matrix.size()) * sizeof(S));
  }
  template <class S>
  void put(std::complex<S>& value) {
    raw(&value, sizeof value);
  }
  template <class T>
  requires(std::is_class_v<T>) void put(T& value) { archive(*this, value); }

  std::string bytes_;
};

/// Throws std::runtime_error when the bytes end early or make no sense.
class ArchiveReader {
 public:
  static constexpr bool reading = true;
  explicit ArchiveReader(std::string_view bytes) : bytes_(bytes) {}
  template <class... T>
  void operator()(T&... values) {
    (get(values), ...);
  }
  [[nodiscard]] bool at_end() const { return bytes_.empty(); }

 private:
  std::string_view raw(std::size_t size) {
    if (size > bytes_.size()) throw std::runtime_error("archive ends early");
    const auto part = bytes_.substr(0, size);
    bytes_.remove_prefix(size);
    return part;
  }
  std::size_t get_size() {
    std::uint64_t n = 0;
    std::memcpy(&n, raw(sizeof n).data(), sizeof n);
    return n;
  }
  template <Plain T>
  void get(T& value) {
    std::memcpy(&value, raw(sizeof value).data(), sizeof value);
  }
  void get(std::string& text) { text = raw(get_size()); }
  void get(nlohmann::ordered_json& json) {
    const auto packed = raw(get_size());
    json = nlohmann::ordered_json::from_msgpack(packed.begin(), packed.end());
  }
  template <class T>
  void get(std::vector<T>& list) {
    const std::size_t size = get_size();
    if (size > bytes_.size()) throw std::runtime_error("archive makes no sense");
    list.resize(size);
    if constexpr (Plain<T> && !std::is_same_v<T, bool>) {
      const auto part = raw(size * sizeof(T));
      if (size > 0) std::memcpy(list.data(), part.data(), part.size());
    } else {
      for (auto& value : list) get(value);
    }
  }
  template <class T>
  void get(std::optional<T>& value) {
    bool there = false;
    get(there);
    value.reset();
    if (there) get(value.emplace());
  }
  template <class A, class B>
  void get(std::pair<A, B>& value) {
    get(value.first);
    get(value.second);
  }
  template <class K, class V>
  void get(std::map<K, V>& map) {
    map.clear();
    for (std::size_t n = get_size(); n > 0; --n) {
      K key{};
      get(key);
      get(map[key]);
    }
  }
  template <std::size_t I = 0, class... T>
  void get_alternative(std::variant<T...>& value, std::size_t index) {
    if constexpr (I < sizeof...(T)) {
      if (index != I) return get_alternative<I + 1>(value, index);
      get(value.template emplace<I>());
    } else {
      throw std::runtime_error("archive makes no sense");
    }
  }
  template <class... T>
  void get(std::variant<T...>& value) {
    get_alternative(value, get_size());
  }
  template <class S, int R, int C>
  void get(Eigen::Matrix<S, R, C>& matrix) {
    const std::size_t rows = get_size(), cols = get_size();
    if (rows > bytes_.size() + 1 || cols > bytes_.size() + 1) {
      throw std::runtime_error("archive makes no sense");
    }
    const auto part = raw(rows * cols * sizeof(S));
    matrix.resize(static_cast<Eigen::Index>(rows), static_cast<Eigen::Index>(cols));
    if (!part.empty()) std::memcpy(static_cast<void*>(matrix.data()), part.data(), part.size());
  }
  template <class S>
  void get(std::complex<S>& value) {
    std::memcpy(static_cast<void*>(&value), raw(sizeof value).data(), sizeof value);
  }
  template <class T>
  requires(std::is_class_v<T>) void get(T& value) { archive(*this, value); }

  std::string_view bytes_;
};

}  // namespace rigfit::apps
