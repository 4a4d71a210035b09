// SPDX-License-Identifier: MIT
// Bodies of torch_file.hpp.
#pragma once

#include <algorithm>  // reverse
#include <map>        // storages
#include <optional>   // types that are not known

#include <motionlang/file/torch_file.hpp>
#include <motionlang/file/zip.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// The size of the pickle of that number at the start of a file; 0 if the file begins otherwise.
inline std::size_t torch_legacy_magic(std::string_view file) {
  constexpr std::string_view frame{"\x95\x0d\0\0\0\0\0\0\0", 9};  // around the number from protocol 4 on
  if (file.size() < 2 || file[0] != '\x80' || file[1] < 2 || file[1] > 5) return 0;
  const std::size_t start = file.substr(2).starts_with(frame) ? 2 + frame.size() : 2;
  return file.substr(start).starts_with(torch_legacy_number) ? start + torch_legacy_number.size() : 0;
}

struct NamedDType {
  std::string_view name;
  DType dtype;
};

/// "torch.FloatStorage" and the like.
inline std::optional<DType> storage_dtype(std::string_view name) {
  constexpr NamedDType classes[] = {{"Float", DType::F32},     {"Double", DType::F64},      {"Half", DType::F16},
                                    {"BFloat16", DType::BF16}, {"Long", DType::I64},        {"Int", DType::I32},
                                    {"Short", DType::I16},     {"Char", DType::I8},         {"Byte", DType::U8},
                                    {"Bool", DType::BOOL},     {"ComplexFloat", DType::C64}};
  if (!name.starts_with("torch.") || !name.ends_with("Storage")) return std::nullopt;
  name = name.substr(name.rfind('.') + 1);
  name.remove_suffix(std::string_view("Storage").size());
  for (const NamedDType& c : classes) {
    if (c.name == name) return c.dtype;
  }
  return std::nullopt;
}

/// "torch.float32" and the like.
inline std::optional<DType> torch_dtype(std::string_view name) {
  constexpr NamedDType types[] = {{"float32", DType::F32},
                                  {"float64", DType::F64},
                                  {"float16", DType::F16},
                                  {"bfloat16", DType::BF16},
                                  {"int64", DType::I64},
                                  {"int32", DType::I32},
                                  {"int16", DType::I16},
                                  {"int8", DType::I8},
                                  {"uint8", DType::U8},
                                  {"uint16", DType::U16},
                                  {"uint32", DType::U32},
                                  {"uint64", DType::U64},
                                  {"bool", DType::BOOL},
                                  {"float8_e4m3fn", DType::F8_E4M3},
                                  {"float8_e5m2", DType::F8_E5M2},
                                  {"complex64", DType::C64}};
  if (!name.starts_with("torch.")) return std::nullopt;
  for (const NamedDType& t : types) {
    if (t.name == name.substr(6)) return t.dtype;
  }
  return std::nullopt;
}

inline std::uint64_t bytes_of(DType t) { return static_cast<std::uint64_t>(info(t).bits) / 8; }

/// A tensor as the pickle describes it: elements of a storage, in any order. Offset and strides count elements.
struct StridedTensor {
  DType dtype = DType::F32;
  std::span<const std::byte> storage;
  std::uint64_t offset = 0;
  FileShape shape, strides;
  bool swapped = false;  // big-endian

  bool contiguous() const {
    Index expected = 1;
    for (int axis = shape.rank(); axis-- > 0;) {
      if (shape[axis] != 1 && strides[axis] != expected) return false;
      expected *= shape[axis];
    }
    return true;
  }
};

/// The elements in row-major order. Visits them with an odometer of indices.
inline std::vector<std::byte> gathered(const StridedTensor& t) {
  const std::uint64_t size = bytes_of(t.dtype);
  std::vector<std::byte> out(static_cast<std::size_t>(t.shape.count()) * size);
  FileShape index = t.shape;
  for (int axis = 0; axis < index.rank(); ++axis) index[axis] = 0;
  std::uint64_t at = t.offset;
  for (std::size_t to = 0; to < out.size(); to += size) {
    std::memcpy(out.data() + to, t.storage.data() + at * size, size);
    if (t.swapped && t.dtype == DType::C64) {  // two numbers, each of them swapped
      std::reverse(out.data() + to, out.data() + to + size / 2);
      std::reverse(out.data() + to + size / 2, out.data() + to + size);
    } else if (t.swapped) {
      std::reverse(out.data() + to, out.data() + to + size);
    }
    for (int axis = t.shape.rank(); axis-- > 0;) {
      at += static_cast<std::uint64_t>(t.strides[axis]);
      if (++index[axis] < t.shape[axis]) break;
      at -= static_cast<std::uint64_t>(t.strides[axis] * index[axis]);
      index[axis] = 0;
    }
  }
  return out;
}

/// Checks that pairs of a size and a stride are in range: every element lies in a storage of `count` elements. Returns
/// the reason if not.
inline const char* out_of_range(const StridedTensor& t, std::uint64_t count) {
  constexpr std::uint64_t most_repeated = std::uint64_t{1}
                                          << 20;  // elements of a tensor that repeats those of its storage
  const std::uint64_t most = std::max(count, most_repeated);
  std::uint64_t product = 1;
  bool empty = false;
  for (int axis = 0; axis < t.shape.rank(); ++axis) {
    const auto n = static_cast<std::uint64_t>(t.shape[axis]);
    empty = empty || n == 0;
    if (n > 1 && product > most / n) return "has more elements than its storage allows";
    product *= std::max<std::uint64_t>(n, 1);
  }
  if (empty) return nullptr;
  if (t.offset >= count) return "begins behind the end of its storage";
  std::uint64_t room = count - 1 - t.offset;
  for (int axis = 0; axis < t.shape.rank(); ++axis) {
    const auto steps = static_cast<std::uint64_t>(t.shape[axis]) - 1,
               stride = static_cast<std::uint64_t>(t.strides[axis]);
    if (steps > 0 && stride > room / steps) return "reaches behind the end of its storage";
    if (steps > 0) room -= steps * stride;
  }
  return nullptr;
}

/// The tensors of one pickle, given the storages that it refers to.
class TorchTensors {
 public:
  using Storages = std::map<std::string, std::span<const std::byte>, std::less<>>;

  explicit TorchTensors(std::shared_ptr<TensorMemory> memory) : memory_(std::move(memory)) {}

  void add_storage(std::string key, std::span<const std::byte> bytes) {
    memory_->spend(sizeof(Storages::value_type) + 4 * sizeof(void*) + key.size());
    storages_.emplace(std::move(key), bytes);
  }
  void set_swapped(bool swapped) { swapped_ = swapped; }

  static bool is_tensor(const PickleValue& v) {
    constexpr std::string_view functions[] = {"torch._utils._rebuild_tensor_v2", "torch._utils._rebuild_tensor_v3",
                                              "torch._utils._rebuild_tensor", "torch._utils._rebuild_parameter",
                                              "torch._utils._rebuild_parameter_with_state"};
    return v.is(PickleKind::object) &&
           std::find(std::begin(functions), std::end(functions), v.name()) != std::end(functions);
  }

  TensorView tensor(PickleValue v) const {
    constexpr int deepest = 8;
    for (int depth = 0; is_tensor(v) && v.name().find("_rebuild_parameter") != std::string::npos; ++depth) {
      if (depth == deepest) v.fail(405, "a parameter of a parameter, more than ", deepest, " deep");
      v = v.arguments()[0];
    }
    if (!is_tensor(v)) v.fail(407, "a tensor expected, found ", v.name().empty() ? to_string(v.kind()) : v.name());
    const StridedTensor t = described(v);
    const std::uint64_t size = bytes_of(t.dtype), bytes = static_cast<std::uint64_t>(t.shape.count()) * size;
    TensorView view{.name = {}, .dtype = t.dtype, .shape = t.shape, .bytes = {}};
    if (bytes == 0) return view;
    if (t.contiguous() && !t.swapped) {
      view.bytes = t.storage.subspan(static_cast<std::size_t>(t.offset * size), static_cast<std::size_t>(bytes));
    } else {
      memory_->spend(bytes);
      view.bytes = memory_->keep(gathered(t));
    }
    return view;
  }

 private:
  struct Storage {
    std::span<const std::byte> bytes;
    std::optional<DType> dtype;  // null: the tensor has it
  };

  /// ("storage", class, key, location, number of elements) and, in older files, (key, offset, number) for a part of it.
  Storage storage(const PickleValue& v) const {
    if (v.name() == "torch.storage._load_from_bytes") return nested_storage(v);
    if (!v.is(PickleKind::persistent)) v.fail(403, "a tensor without a storage");
    const PickleValue id = v.arguments();
    if (id.size() < 5 || id[0].text() != "storage") v.fail(403, "not the id of a storage");
    const std::string type = id[1].name();
    const bool untyped = type.ends_with("UntypedStorage");
    const auto dtype = storage_dtype(type);
    if (!untyped && !dtype) v.fail(404, "a storage of class ", type.empty() ? "?" : type);
    const std::uint64_t size = untyped ? 1 : bytes_of(*dtype);
    const auto found = storages_.find(id[2].text());
    if (found == storages_.end()) v.fail(403, "storage '", id[2].text(), "' is not in the file");
    std::span<const std::byte> bytes = found->second;
    const std::int64_t count = id[4].integer();
    if (count < 0 || static_cast<std::uint64_t>(count) != bytes.size() / size || bytes.size() % size != 0) {
      v.fail(405, "storage '", id[2].text(), "' has ", counted(bytes.size(), "byte"), ", not ", count, " times ", size);
    }
    if (id.size() > 5 && !id[5].is(PickleKind::none)) {
      const std::int64_t first = id[5][1].integer(), part = id[5][2].integer();
      if (first < 0 || part < 0 || first > count || part > count - first) v.fail(405, "a part outside of its storage");
      bytes = bytes.subspan(static_cast<std::size_t>(first) * size, static_cast<std::size_t>(part) * size);
    }
    return {bytes, dtype};
  }
  Storage nested_storage(const PickleValue& v) const;

  StridedTensor described(const PickleValue& v) const {
    const PickleValue given = v.arguments();
    const std::string function = v.name();
    const Storage from = storage(given[0]);
    StridedTensor t;
    std::optional<DType> dtype = from.dtype;
    if (function.ends_with("_v3")) dtype = torch_dtype(given[6].name());
    if (!dtype) v.fail(404, "a tensor of unknown element type");
    t.dtype = *dtype;
    t.storage = from.bytes;
    const std::int64_t offset = given[1].integer();
    if (offset < 0) v.fail(405, "a tensor with a negative offset");
    t.offset = static_cast<std::uint64_t>(offset);
    t.shape = sizes(given[2]);
    t.strides = sizes(given[3]);
    t.swapped = swapped_ && bytes_of(t.dtype) > 1;
    // The metadata of _rebuild_tensor_v2, since PyTorch 2: elements that must be negated or conjugated on reading.
    constexpr std::size_t metadata = 6;
    if (function.ends_with("_v2") && given.size() > metadata && given[metadata].size() > 0)
      v.fail(404, "a tensor that is negated or conjugated when it is read");
    if (t.shape.rank() != t.strides.rank())
      v.fail(403, "a tensor with ", counted(t.shape.rank(), "size"), " and ", counted(t.strides.rank(), "stride"));
    if (const char* problem = out_of_range(t, t.storage.size() / bytes_of(t.dtype))) {
      v.fail(405, "a tensor of shape ", t.shape, " ", problem);
    }
    return t;
  }
  /// A tuple, or torch.Size.
  static FileShape sizes(const PickleValue& v) {
    const PickleValue list = v.name() == "torch.Size" ? v.arguments()[0] : v;
    FileShape shape;
    for (std::size_t i = 0; i < list.size(); ++i) {
      const std::int64_t n = list[i].integer();
      if (n < 0) v.fail(405, "a tensor with a negative size or stride");
      if (shape.rank() == FileShape::max_rank) v.fail(404, "a tensor with more than ", FileShape::max_rank, " axes");
      shape.push_back(static_cast<Index>(n));
    }
    return shape;
  }

  std::shared_ptr<TensorMemory> memory_;
  Storages storages_;
  bool swapped_ = false;
};

/// Five pickles in a row, followed by the storages. Fills `storages`; returns the pickle of the object.
inline Pickle read_torch_legacy(std::span<const std::byte> bytes, const std::string& name, TorchTensors& tensors,
                                const std::shared_ptr<TensorMemory>& memory) {
  const auto part = [&](std::uint64_t start, bool persistent = false, std::uint64_t most = 0) {
    return Pickle(bytes, name, {.persistent_ids = persistent, .max_memory = most}, memory, start);
  };
  const auto end_of_version = [&] {  // nothing of these two pickles is kept
    const Pickle version = part(torch_legacy_magic(as_text(bytes)));
    if (version.root().integer() != 1001)
      version.root().fail(404, "protocol ", version.root().integer(), " of PyTorch");
    return version.end();
  }();
  const auto end_of_system = [&] {
    const Pickle system = part(end_of_version);
    tensors.set_swapped(!system.root()["little_endian"].boolean());
    return system.end();
  }();
  Pickle object = part(end_of_system, true);

  std::map<std::string, std::uint64_t, std::less<>> element_size;
  for (const PickleValue& v : object.persistent()) {
    const PickleValue id = v.arguments();
    if (id.size() < 5) v.fail(403, "not the id of a storage");
    const auto dtype = storage_dtype(id[1].name());
    memory->spend(2 * sizeof(std::string) + 6 * sizeof(void*) + id[2].text().size());
    element_size.emplace(id[2].text(), dtype ? bytes_of(*dtype) : 1);
  }
  // Both are in memory at the same time: together they may need as much as one.
  const Pickle keys = part(object.end(), false, std::max<std::uint64_t>(1, object.memory_left()));
  std::uint64_t at = keys.end();
  for (std::size_t i = 0; i < keys.root().size(); ++i) {
    const PickleValue key = keys.root()[i];
    const auto size = element_size.find(key.text());
    if (size == element_size.end()) key.fail(403, "storage '", key.text(), "' belongs to no tensor");
    const auto count = load<std::uint64_t>(bytes, at, name, "the size of a storage");
    at += sizeof count;
    if (count > bytes.size() / size->second) {
      raise<io_error>(405, name, ": storage '", key.text(), "' of ", counted(count, "element"), " at byte ", at, " of ",
                      bytes.size());
    }
    tensors.add_storage(std::string(key.text()), slice(bytes, at, count * size->second, name, "a storage"));
    at += count * size->second;
  }
  return object;
}

/// A storage that was pickled with the object: an older file inside, as bytes.
inline TorchTensors::Storage TorchTensors::nested_storage(const PickleValue& v) const {
  const auto bytes = v.arguments()[0].bytes();
  if (torch_legacy_magic(as_text(bytes)) == 0) v.fail(403, "bytes that are not a storage of PyTorch");
  memory_->spend(bytes.size());  // also for the time: many tensors may name the same bytes
  TorchTensors inner(memory_);
  const Pickle object = read_torch_legacy(bytes, v.file(), inner, memory_);
  if (!object.root().is(PickleKind::persistent)) v.fail(403, "bytes that are not a storage of PyTorch");
  if (inner.swapped_) v.fail(404, "a big-endian storage in a little-endian file");
  return inner.storage(object.root());
}

}  // namespace detail

MOTIONLANG_BODY TorchFile TorchFile::open(const FilePath& path) {
  const auto file = MappedFile::open(path);
  return from_bytes(file->bytes(), path.string(), file);
}

MOTIONLANG_BODY TorchFile TorchFile::from_bytes(std::span<const std::byte> bytes, const std::string& name,
                                                std::shared_ptr<const void> owner) {
  const auto memory = std::make_shared<TensorMemory>(std::move(owner), bytes.size(), name);
  return is_legacy(bytes) ? from_legacy(bytes, name, memory) : from_archive(ZipArchive(bytes, name), memory);
}

MOTIONLANG_BODY TorchFile TorchFile::from_legacy(std::span<const std::byte> bytes, const std::string& name,
                                                 const std::shared_ptr<TensorMemory>& memory) {
  detail::TorchTensors tensors(memory);
  Pickle object = detail::read_torch_legacy(bytes, name, tensors, memory);
  return TorchFile(std::move(object), std::move(tensors), memory, "torch legacy");
}

MOTIONLANG_BODY TorchFile TorchFile::from_archive(const ZipArchive& zip, const std::shared_ptr<TensorMemory>& memory,
                                                  bool checksums) {
  const std::string folder = root_folder(zip);
  if (folder.empty()) raise<io_error>(403, zip.name(), ": no data.pkl in the archive: not a file of PyTorch");
  for (const ZipEntry& e : zip.entries()) {
    if (is_root_pickle(e.name) && !e.name.starts_with(folder))
      raise<io_error>(403, zip.name(), ": both '", folder, "data.pkl' and '", e.name, "' at byte ", e.offset,
                      ": which is meant?");
  }
  detail::TorchTensors tensors(memory);
  const std::string data = folder + "data/";
  bool script = false;
  for (const ZipEntry& e : zip.entries()) {
    script = script || e.name == folder + "constants.pkl" || e.name.starts_with(folder + "code/");
    if (!e.name.starts_with(data)) continue;
    if (e.deflated) memory->spend(e.size);
    tensors.add_storage(e.name.substr(data.size()), e.deflated  ? std::span<const std::byte>(memory->keep(zip.read(e)))
                                                    : checksums ? zip.checked(e)
                                                                : zip.stored(e));
  }
  if (const ZipEntry* order = zip.find(folder + "byteorder")) {
    const std::string_view text = detail::as_text(zip.checked(*order));
    if (text != "little" && text != "big") raise<io_error>(403, zip.name(), ": byte order '", utf8_head(text, 16), "'");
    tensors.set_swapped(text == "big");
  }
  const auto bytes = zip.checked(*zip.find(folder + "data.pkl"));
  Pickle object(bytes, concat_text(zip.name(), "/", folder, "data.pkl"), {.persistent_ids = true}, memory);
  const std::uint64_t behind = bytes.size() - object.end();
  TorchFile out(std::move(object), std::move(tensors), memory, script ? "TorchScript" : "torch zip");
  out.behind_ = behind;
  return out;
}

MOTIONLANG_BODY TorchFile TorchFile::from_pickle(Pickle pickle, const std::shared_ptr<TensorMemory>& memory) {
  return TorchFile(std::move(pickle), detail::TorchTensors(memory), memory, "pickle");
}

MOTIONLANG_BODY bool TorchFile::is_legacy(std::span<const std::byte> bytes) {
  return detail::torch_legacy_magic(detail::as_text(bytes)) > 0;
}

MOTIONLANG_BODY std::string TorchFile::root_folder(const ZipArchive& zip) {
  for (const ZipEntry& e : zip.entries()) {
    if (is_root_pickle(e.name)) return e.name.substr(0, e.name.find('/') + 1);
  }
  return "";
}

MOTIONLANG_BODY bool TorchFile::is_tensor(const PickleValue& v) { return detail::TorchTensors::is_tensor(v); }

MOTIONLANG_BODY TensorView TorchFile::tensor(const PickleValue& v) const { return tensors_->tensor(v); }

MOTIONLANG_BODY TorchFile::TorchFile(Pickle object, detail::TorchTensors tensors, std::shared_ptr<TensorMemory> memory,
                                     std::string format)
    : object_(std::move(object)),
      tensors_(std::make_shared<const detail::TorchTensors>(std::move(tensors))),
      memory_(std::move(memory)),
      format_(std::move(format)) {}

MOTIONLANG_BODY bool TorchFile::is_root_pickle(std::string_view member) {
  const std::size_t slash = member.find('/');
  return slash != member.npos && member.substr(slash + 1) == "data.pkl";
}

MOTIONLANG_NAMESPACE_END
