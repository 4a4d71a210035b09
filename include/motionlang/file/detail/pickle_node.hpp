// SPDX-License-Identifier: MIT
/// The values of a pickle, as the stack machine makes them.
#pragma once

#include <cstdint>      // places in the file
#include <span>         // file
#include <string>       // messages
#include <string_view>  // texts in the file
#include <vector>       // items

#include <motionlang/version.hpp>

MOTIONLANG_NAMESPACE_BEGIN

enum class PickleKind : std::uint8_t {
  none,
  boolean,
  integer,
  real,
  text,   // also whole numbers of more than 64 bits in protocol 0, as digits
  bytes,  // also the texts of Python 2, and such numbers in other protocols, little-endian
  list,   // also sets
  tuple,
  dict,
  name,        // of a class or a function
  object,      // the inert result of calling one
  persistent,  // something outside the pickle, known by an id
};
inline std::string_view name_of(PickleKind k) {
  constexpr std::string_view names[] = {"None",         "a truth value", "a whole number", "a real number",
                                        "a text",       "bytes",         "a list",         "a tuple",
                                        "a dictionary", "a name",        "an object",      "a persistent id"};
  return names[static_cast<std::size_t>(k)];
}
inline std::string to_string(PickleKind k) { return std::string(name_of(k)); }

class PickleValue;

/// Bytes in the file that belong to an object but not to the pickle.
struct InlineBytes {
  std::uint64_t begin = 0, size = 0;  // begin 0: there are none
};

struct PickleOptions {
  /// Names that may occur: "collections.OrderedDict" or, ending with a dot, everything below a module: "numpy.". Empty:
  /// all names except those that execute something. Unknown classes are inert objects.
  std::span<const std::string_view> allowed{};
  bool persistent_ids = false;         // PyTorch's storages
  std::size_t max_values = 4'000'000;  // values and links between them; never more than the size of the file allows
  std::uint64_t max_memory = 0;        // bytes for them; 0: 24 MiB plus the size of the file
  /// Called with every object that has its state. Returns the bytes at `position` that belong to it (joblib's arrays).
  /// Reading continues after them.
  InlineBytes (*inline_bytes)(const PickleValue& object, std::span<const std::byte> file,
                              std::uint64_t position) = nullptr;
};

namespace detail {

using PickleRef = std::uint32_t;
inline constexpr PickleRef no_pickle_value = UINT32_MAX;

struct PickleNode {
  PickleKind kind = PickleKind::none;
  bool keyed = false;  // items are keys and values in turn
  PickleRef callee = no_pickle_value, arguments = no_pickle_value, state = no_pickle_value;
  std::uint64_t at = 0;
  std::int64_t integer = 0;
  double real = 0;
  std::string_view text, attribute;  // of a name: module and attribute; of an object: the bytes after it
  std::vector<PickleRef> items;
};

}  // namespace detail

MOTIONLANG_NAMESPACE_END
