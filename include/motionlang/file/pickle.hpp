// SPDX-License-Identifier: MIT
/// Python pickles, protocols 0 to 5, read without executing anything.
///
/// A pickle is a program that builds objects. This reader runs the part that builds plain values (numbers, texts,
/// lists, dictionaries). It turns every class and every call into an inert `object` that records name, arguments, state
/// and items. The caller decides by the name what such an object means. file/pickle_arrays.hpp does this for NumPy,
/// SciPy and chumpy. Tensors of PyTorch are objects whose storages are `persistent`.
///
///     Pickle file = Pickle::open("model.pkl");
///     NpyArray weights = to_array(file.root()["weights"]);
///
/// The reader refuses malformed pickles, and names that only an attack needs (os.system, eval). The size of the file
/// bounds the memory: lengths are checked before anything is allocated, and texts and bytes are views into the file.
///
/// Source  CPython Lib/pickle.py and pickletools.py
#pragma once

#include <cstdint>      // numbers
#include <memory>       // machine
#include <optional>     // entries that may be missing
#include <span>         // bytes
#include <string>       // names
#include <string_view>  // texts
#include <vector>       // persistent values

#include <motionlang/file/detail/pickle_node.hpp>
#include <motionlang/file/file.hpp>

MOTIONLANG_NAMESPACE_BEGIN

class Pickle;

namespace detail {
class PickleMachine;
}

/// A handle to a value in a pickle, valid while its Pickle lives. Graphs may share values and may be cyclic, so limit
/// the depth of a descent.
class PickleValue {
 public:
  PickleKind kind() const { return node().kind; }
  bool is(PickleKind k) const { return kind() == k; }
  /// Equal for handles of the same value.
  std::uint32_t id() const { return ref_; }
  /// Offset of the byte that made it.
  std::uint64_t at() const { return node().at; }
  const std::string& file() const;

  /// Values of these kinds. A whole number can be read as a real one, and a truth value as 0 or 1. Throws io_error 407.
  std::int64_t integer() const;
  bool boolean() const;
  double real() const { return is(PickleKind::real) ? node().real : static_cast<double>(integer()); }
  /// The text as UTF-8. For a string of Python 2, its bytes, which are Latin-1. Throws io_error 407.
  std::string_view text() const;
  std::span<const std::byte> bytes() const;

  /// The number of elements of a list, a tuple or a set, or of entries of a dictionary. For objects, the number of
  /// appended or set items.
  std::size_t size() const { return node().items.size() / (node().keyed ? 2 : 1); }
  /// True if the elements are entries: in dictionaries, and in objects that behave like one.
  bool keyed() const { return node().keyed; }
  /// Element of a sequence. Throws io_error 407 if there is no such element.
  PickleValue operator[](std::size_t i) const;
  /// Key and value of entry i < size() of a dictionary. Throws io_error 407 for other values.
  PickleValue key(std::size_t i) const { return entry(2 * i); }
  PickleValue value(std::size_t i) const { return entry(2 * i + 1); }
  /// The entry of a dictionary with this text as its key. If there are several, the last one, as in Python.
  std::optional<PickleValue> find(std::string_view name) const;
  /// Throws io_error 406 if there is none.
  PickleValue operator[](std::string_view name) const;

  /// "module.attribute" of a name, and of the class or function that made an object; "" for all others.
  std::string name() const;
  /// For an object: the arguments of its class or function. For a persistent value: its id.
  PickleValue arguments() const { return related(node().arguments, "arguments"); }
  /// For an object: the state from which it restores itself.
  PickleValue state() const { return related(node().state, "a state"); }
  bool has_state() const { return node().state != detail::no_pickle_value; }
  /// For an object: the bytes after it that are not part of the pickle (PickleOptions::inline_bytes).
  std::span<const std::byte> inline_bytes() const;

  /// For readers of objects: throws io_error `id` with the file, the fault and the place.
  template <class... T>
  [[noreturn]] void fail(int id, const T&... what) const {
    fail_with(id, concat_text(what...));
  }

 private:
  friend class Pickle;
  friend class detail::PickleMachine;
  PickleValue(const detail::PickleMachine& machine, detail::PickleRef ref) : machine_(&machine), ref_(ref) {}
  const detail::PickleNode& node() const;
  [[noreturn]] void fail_with(int id, const std::string& what) const;
  [[noreturn]] void wrong(const char* expected) const;
  PickleValue entry(std::size_t i) const;
  PickleValue related(detail::PickleRef ref, const char* what) const;

  const detail::PickleMachine* machine_;
  detail::PickleRef ref_;
};

/// A pickle that has been read.
class Pickle {
 public:
  /// file    for messages
  /// owner   keeps `bytes` alive
  /// start   of the pickle in the bytes; several pickles may follow each other
  /// Throws  io_error 402 if it ends too early, 403 if it is malformed, 405 beyond the limits; 404 if it names
  ///         something that must not be executed or that `options` do not allow, or uses an extension
  Pickle(std::span<const std::byte> bytes, std::string file, const PickleOptions& options = {},
         std::shared_ptr<const void> owner = nullptr, std::uint64_t start = 0);
  /// Throws io_error 401, and as above.
  static Pickle open(const FilePath& path, const PickleOptions& options = {});

  Pickle(Pickle&&) noexcept;
  Pickle& operator=(Pickle&&) noexcept;
  ~Pickle();

  PickleValue root() const { return {*machine_, root_}; }
  /// The values that represent something outside of the pickle, in the order of the file.
  std::vector<PickleValue> persistent() const;
  /// The number of bytes that may still be used.
  std::uint64_t memory_left() const;
  /// Offset of the end of the pickle.
  std::uint64_t end() const;

 private:
  std::unique_ptr<detail::PickleMachine> machine_;  // values point to it
  std::shared_ptr<const void> owner_;
  detail::PickleRef root_ = 0;
};

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/file/pickle.ipp>
#endif
