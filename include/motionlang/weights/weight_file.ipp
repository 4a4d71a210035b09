// SPDX-License-Identifier: MIT
// Bodies of weight_file.hpp.
#pragma once

#include <algorithm>      // find, none_of
#include <unordered_map>  // objects that were looked into

#include <motionlang/core/sort.hpp>
#include <motionlang/file/detail/inflate.hpp>
#include <motionlang/file/gzip.hpp>
#include <motionlang/file/json.hpp>  // weight_map
#include <motionlang/file/npz.hpp>
#include <motionlang/file/pickle_arrays.hpp>
#include <motionlang/file/torch_file.hpp>
#include <motionlang/weights/known_systems.hpp>
#include <motionlang/weights/weight_file.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY void WeightFile::sort_tensors() {
  detail::sort(tensors_, [](const TensorView& a, const TensorView& b) { return a.name < b.name; });
  for (std::size_t i = 1; i < tensors_.size(); ++i) {
    if (tensors_[i - 1].name == tensors_[i].name)
      raise<io_error>(403, name_, ": two tensors are called '", tensors_[i].name, "'");
  }
}

namespace detail {

/// Fills a WeightFile.
class WeightReader {
 public:
  /// file_size   a valid file has no more values to visit than bytes
  WeightReader(WeightFile& out, TensorMemory& memory, const WeightOptions& options, std::uint64_t file_size)
      : out_(out),
        memory_(memory),
        options_(options),
        visits_left_(std::min(10'000 + file_size, most_visits)),
        visits_for_known_(visits_left_ / 2) {}

  void read(const TorchFile& file) {
    torch_ = &file;
    separator_ = file.format() == "pickle" ? '/' : '.';
    const std::string selection = options_.path ? *options_.path : default_path(file.root());
    find_selection(file.root(), selection);
    visit(file.root());
    if (separator_ == '/' && joblib_) out_.format_ = "joblib";
  }
  void read(const NpzArchive& file, const ZipArchive& zip) {
    constexpr std::string_view suffix = ".npy";
    for (const ZipEntry& e : zip.entries()) {
      if (!e.name.ends_with(suffix)) continue;
      path_.assign(1, std::string_view(e.name).substr(0, e.name.size() - suffix.size()));
      attempt(e.name, [&] {
        if (e.deflated) memory_.spend(e.size);
        const auto bytes = e.deflated ? std::span<const std::byte>(memory_.keep(zip.read(e))) : zip.checked(e);
        add_npy(bytes, concat_text(file.file(), "/", e.name));
      });
    }
  }
  void read_npy(std::span<const std::byte> bytes) { add_npy(bytes, out_.name()); }

 private:
  static constexpr std::size_t deepest = 64, most_values = 10'000, most_texts = 1'000, most_skipped = 1'000;
  static constexpr std::uint64_t most_visits = 2'000'000;

  // The keys to look for.

  bool holds_tensors(const PickleValue& v) const {
    for (std::size_t i = 0; v.is(PickleKind::dict) && i < v.size(); ++i) {
      if (TorchFile::is_tensor(v.value(i))) return true;
    }
    return false;
  }
  std::string default_path(const PickleValue& root) const {
    if (!root.is(PickleKind::dict) || holds_tensors(root)) return "";
    for (const char* key : {"state_dict", "model_state_dict", "model"}) {
      if (const auto found = root.find(key); found && holds_tensors(*found)) return key;
    }
    return "";
  }
  void find_selection(PickleValue v, std::string_view keys) {
    while (!keys.empty()) {
      const std::size_t slash = std::min(keys.find('/'), keys.size());
      selection_.emplace_back(keys.substr(0, slash));
      const auto found = entry(v, selection_.back());
      if (!found)
        raise<io_error>(406, out_.name(), ": no entry '", selection_.back(), "' in the value at byte ", v.at());
      v = *found;
      keys.remove_prefix(std::min(slash + 1, keys.size()));
    }
  }
  /// The value of a key: a text, a number, or the place in a list.
  static std::optional<PickleValue> entry(const PickleValue& v, std::string_view key) {
    if (const auto found = v.find(key)) return found;
    for (std::size_t i = 0; i < v.size(); ++i) {
      if (!v.keyed() && concat_text(i) == key) return v[i];
      if (v.keyed() && v.key(i).is(PickleKind::integer) && concat_text(v.key(i).integer()) == key) return v.value(i);
    }
    return std::nullopt;
  }
  bool selected() const {
    return unknown_.empty() && path_.size() >= selection_.size() &&
           std::equal(selection_.begin(), selection_.end(), path_.begin());
  }

  // Walking through a pickle.

  /// A budget of time: as many values as the file justifies. Slow visits count as more than one.
  void spend_visits(const PickleValue& v, std::uint64_t count = 1) {
    if (visits_left_ < count) v.fail(405, "more values to look at than the file justifies");
    visits_left_ -= count;
  }
  void visit(const PickleValue& v) {
    spend_visits(v);
    if (path_.size() > deepest || depth_ > 4 * deepest) return skip("a value that is nested too deeply", "");
    ++depth_;
    visit_kind(v);
    --depth_;
  }
  void visit_kind(const PickleValue& v) {
    switch (v.kind()) {
      case PickleKind::boolean:
        return torch_->format() == "TorchScript" ? void() : add_value(v.boolean());
      case PickleKind::integer:
        return add_value(v.integer());
      case PickleKind::real:
        return add_value(v.real());
      case PickleKind::text:
      case PickleKind::bytes:
        return add_text(v.text());
      case PickleKind::list:
      case PickleKind::tuple:
        return visit_list(v);
      case PickleKind::dict:
        return visit_entries(v);
      case PickleKind::object:
        return visit_object(v);
      default:
        return;
    }
  }
  void visit_at(std::string_view key, const PickleValue& v) {
    path_.push_back(key);
    visit(v);
    path_.pop_back();
  }
  void visit_entries(const PickleValue& v) {
    for (std::size_t i = 0; i < v.size(); ++i) {
      const PickleValue key = v.key(i);
      if (key.is(PickleKind::text) || key.is(PickleKind::bytes))
        visit_at(key.text(), v.value(i));
      else if (key.is(PickleKind::integer))
        visit_at(concat_text(key.integer()), v.value(i));
      else
        skip(concat_text("an entry whose key is ", key.kind()), "");
    }
  }
  void visit_list(const PickleValue& v) {
    if (separator_ == '/' && add_numbers(v)) return;
    for (std::size_t i = 0; i < v.size(); ++i) visit_at(concat_text(i), v[i]);
  }

  /// Entry of a dictionary that many objects may share.
  std::optional<PickleValue> find_counted(const PickleValue& dict, std::string_view key) {
    spend_visits(dict, dict.size() / 8);
    return dict.find(key);
  }
  /// The value of an object of omegaconf, or of a class with the same form.
  std::optional<PickleValue> content(const PickleValue& state) {
    const auto inner = find_counted(state, "_content");
    return inner ? inner : find_counted(state, "_val");
  }

  void visit_object(const PickleValue& v) {
    const std::string name = v.name();
    spend_visits(v, name.size() / 256);
    const auto state = v.has_state() && v.state().is(PickleKind::dict) ? std::optional(v.state()) : std::nullopt;
    if (TorchFile::is_tensor(v)) {
      if (selected()) attempt(name, [&] { add_tensor(torch_->tensor(v)); });
    } else if (is_numpy_scalar(v)) {
      attempt(name, [&] { add_number(to_array(v)); });
    } else if (is_numpy_array(v)) {
      joblib_ = joblib_ || is_joblib_array(v);
      attempt(name, [&] { add_array(pickled_array(v), is_joblib_array(v)); });
    } else if (name.starts_with("chumpy.") || name.starts_with("scipy.sparse.")) {
      if (selected()) attempt(name, [&] { add_copy(to_array(v)); });
    } else if (const auto inner = name.starts_with("omegaconf.") && state ? content(*state) : std::nullopt) {
      visit(*inner);
    } else if (name.starts_with("pathlib.")) {
      add_path(v.arguments());
    } else if (name == "torch.Size" || name == "torch.device") {
      if (v.arguments().size() > 0) visit(v.arguments()[0]);
    } else if (state && (name.starts_with("__torch__.") || name == "argparse.Namespace")) {
      visit_entries(*state);
    } else if (v.size() > 0) {  // of a class that behaves like a list or a dictionary
      v.keyed() ? visit_entries(v) : visit_list(v);
      visit_unknown(v);
    } else {
      if (unknown_.empty()) skip(name, "an object of class ");
      visit_unknown(v);
    }
  }

  /// Reads the fields of an object of an unknown class as values. Its tensors are skipped, because the class may give
  /// them any meaning. Objects may share others and refer back to themselves. So each is visited a few times at most,
  /// and all of them together leave enough visits for known objects.
  void visit_unknown(const PickleValue& v) {
    constexpr int most_looks = 4;
    const bool inside = std::find(unknown_.begin(), unknown_.end(), v.id()) != unknown_.end();
    if (inside || looks_.size() >= most_values || out_.values_.size() >= most_values) return;
    if (++looks_[v.id()] > most_looks) return;
    const std::uint64_t kept = unknown_.empty() ? std::min(visits_left_, visits_for_known_) : 0;
    visits_left_ -= kept;
    unknown_.push_back(v.id());
    const std::size_t keys = path_.size(), depth = depth_;
    guard<io_error>([&] { visit_fields(v); }, [](const io_error&) { return true; });
    path_.resize(keys);  // if there were too many
    depth_ = depth;
    unknown_.pop_back();
    visits_left_ += kept;
  }
  /// Fields are the entries of dictionaries: of the state, of several dictionaries in the state (attributes and slots,
  /// the keywords of functools.partial), and among the arguments of the call that made the object. An object that was
  /// made from one other value, as an Enum is, stands for that value.
  void visit_fields(const PickleValue& v) {
    constexpr std::size_t most_dictionaries = 8;
    std::vector<PickleValue> fields;
    const auto add = [&](const PickleValue& from) {
      spend_visits(v, from.size() / 8);
      if (from.keyed()) return fields.push_back(from);
      for (std::size_t i = 0; i < from.size() && fields.size() < most_dictionaries; ++i) {
        if (from[i].keyed()) fields.push_back(from[i]);
      }
    };
    add(v.arguments());
    if (v.has_state()) add(v.state());
    for (const PickleValue& f : fields) {
      if (const auto inner = content(f)) return visit(*inner);
    }
    std::vector<PickleValue> visited;
    if (v.keyed()) visited.push_back(v);
    for (const PickleValue& f : fields) {
      if (std::none_of(visited.begin(), visited.end(),
                       [&](const PickleValue& other) { return have_same_keys(f, other); }))
        visit_entries(f);
      visited.push_back(f);
    }
    const bool alone = visited.empty() && v.size() == 0 && !v.has_state() && v.arguments().size() == 1;
    if (alone) visit(v.arguments()[0]);
  }
  /// Compares the number of keys and the first one: some classes keep their entries as attributes, too.
  static bool have_same_keys(const PickleValue& a, const PickleValue& b) {
    return a.size() == b.size() && a.size() > 0 && a.key(0).is(PickleKind::text) && b.find(a.key(0).text());
  }

  // The results.

  /// Calls `read`. It skips values that are not supported, and all errors if no tensors are wanted.
  template <class F>
  void attempt(const std::string& name, F read) {
    constexpr std::uint64_t visits_of_a_failure = 50;
    guard<io_error>(read, [&](const io_error& e) {
      visits_left_ -= std::min(visits_left_, visits_of_a_failure);
      if (selected() && (e.id() != 404 || options_.strict)) return false;
      skip(name, "");
      return true;
    });
  }
  void skip(const std::string& name, const char* what) {
    if (options_.strict && selected())
      raise<io_error>(404, out_.name(), ": ", what, name, " at '", joined(0, '/'), "'");
    if (out_.skipped_.size() >= most_skipped) return;
    memory_.spend(3 * sizeof(SkippedValue) + name.size());
    out_.skipped_.push_back({joined(0, '/'), name});
  }

  std::string joined(std::size_t first, char separator) const {
    std::size_t size = 0;
    for (std::size_t i = first; i < path_.size(); ++i) size += path_[i].size() + 1;
    memory_.spend(size);
    std::string out;
    out.reserve(size);
    for (std::size_t i = first; i < path_.size(); ++i) {
      if (i > first) out += separator;
      out += path_[i];
    }
    return out;
  }

  template <class T>
  void add_value(T value) {
    if (out_.values_.size() >= most_values) return;
    memory_.spend(3 * sizeof(FileValue));
    out_.values_.push_back({joined(0, '/'), std::move(value)});
  }
  void add_text(std::string_view text) {
    if (out_.values_.size() >= most_values || !is_utf8(text) || text.find('\0') != std::string_view::npos) return;
    memory_.spend(text.size());
    add_value(std::string(text));
  }
  void add_path(const PickleValue& parts) {
    std::string out;
    for (std::size_t i = 0; i < parts.size(); ++i) {
      const std::string_view part = parts[i].text();
      memory_.spend(2 * part.size());
      out += concat_text(i > 0 && out != "/" ? "/" : "", part);
    }
    add_text(out);
  }
  void add_number(const NpyArray& a) {
    if (a.is_text()) return add_text(a.text());
    if (a.kind == 'f') return add_value(a.value<double>());
    if (a.kind == 'b') return add_value(a.value<int>() != 0);
    add_value(a.value<std::int64_t>());
  }

  void add_tensor(TensorView view) {
    memory_.spend(3 * sizeof(TensorView) + static_cast<std::size_t>(view.shape.rank()) * sizeof(Index));
    view.name = joined(selection_.size(), separator_);
    if (view.name.empty()) view.name = "array";
    out_.tensors_.push_back(std::move(view));
  }
  /// Elements of an array as a tensor.
  void add_elements(char kind, std::size_t size, const std::vector<Index>& shape, std::span<const std::byte> bytes) {
    if (shape.size() > FileShape::max_rank)
      raise<io_error>(404, out_.name(), ": an array with ", counted(shape.size(), "axis", "axes"));
    DType dtype = kind == 'b' ? DType::BOOL : DType::F16;
    if (kind != 'b' && !(kind == 'f' && size == 2)) {
      with_npy_number(kind, size, [&](auto number) {
        if constexpr (std::is_arithmetic_v<decltype(number)>) dtype = motionlang::dtype_of<decltype(number)>();
      });
    }
    add_tensor({.name = {}, .dtype = dtype, .shape = FileShape(std::span<const Index>(shape)), .bytes = bytes});
  }
  void add_copy(NpyArray array) {
    memory_.spend(array.data.size() + array.place.size());
    const NpyArray& kept = memory_.keep(std::move(array));
    add_elements(kept.kind, kept.item_size, kept.shape, kept.data);
  }
  /// lasting   the bytes live as long as the file
  void add_array(const PickledArray& a, bool lasting) {
    const NpyArray described = described_array(a.type, a.shape, a.where);
    check_raw_size(described, a.raw.size(), a.where);
    if (described.is_text()) return add_texts(described, a);
    if (!selected()) return;
    const bool in_order = !a.fortran_order || a.shape.size() < 2;
    if (lasting && in_order && (a.type[0] != '>' || described.item_size == 1)) {
      return add_elements(described.kind, described.item_size, a.shape, a.raw);
    }
    if (a.raw.size() > memory_.left()) memory_.spend(a.raw.size());
    add_copy(stored_array(a.type, a.fortran_order, a.shape, a.raw, a.where));
  }
  void add_texts(const NpyArray& described, const PickledArray& a) {
    const auto count = static_cast<std::size_t>(described.count());
    if (count > most_texts) return skip(described.type(), "texts of type ");
    memory_.spend(2 * a.raw.size());
    const auto texts = stored_array(a.type, a.fortran_order, a.shape, a.raw, a.where).texts();
    if (a.shape.empty()) return add_text(texts.front());
    for (std::size_t i = 0; i < count; ++i) {
      const std::string index = concat_text(i);
      path_.push_back(index);
      add_text(texts[i]);
      path_.pop_back();
    }
  }
  void add_npy(std::span<const std::byte> bytes, const std::string& file) {
    const NpyParts npy = npy_parts(bytes, file);
    add_array({npy.header.descr, npy.header.fortran_order, npy.header.shape, npy.raw, npy.where}, true);
  }
  /// A list of numbers only, as a tensor; false for any other list.
  bool add_numbers(const PickleValue& list) {
    bool real = false;
    for (std::size_t i = 0; i < list.size(); ++i) {
      if (!list[i].is(PickleKind::integer) && !list[i].is(PickleKind::real)) return false;
      real = real || list[i].is(PickleKind::real);
    }
    if (list.size() == 0 || !selected()) return false;
    memory_.spend(2 * sizeof(double) * list.size());
    const auto copy = [&]<class T>(std::vector<T> numbers) {
      for (std::size_t i = 0; i < list.size(); ++i) {
        if constexpr (std::integral<T>)
          numbers.push_back(list[i].integer());
        else
          numbers.push_back(list[i].real());
      }
      add_copy(NpyArray::of(std::span<const T>(numbers), {std::ssize(numbers)}));
    };
    real ? copy(std::vector<double>()) : copy(std::vector<std::int64_t>());
    return true;
  }

  WeightFile& out_;
  TensorMemory& memory_;
  const WeightOptions& options_;
  const TorchFile* torch_ = nullptr;
  char separator_ = '/';
  std::vector<std::string> selection_;
  std::vector<std::string_view> path_;  // keys from the root to the current value
  std::uint64_t visits_left_, visits_for_known_;
  std::vector<std::uint32_t> unknown_;              // objects of unknown classes around the value
  std::unordered_map<std::uint32_t, int> looks_{};  // number of visits to such objects
  std::size_t depth_ = 0;  // values around the current one; objects that stand for another one add no key
  bool joblib_ = false;
};

/// joblib writes compressed dumps as one zlib stream (RFC 1950).
inline bool is_zlib(std::span<const std::byte> bytes) {
  if (bytes.size() < 6) return false;
  const auto first = std::to_integer<unsigned>(bytes[0]), second = std::to_integer<unsigned>(bytes[1]);
  return first == 0x78 && (first * 256 + second) % 31 == 0;
}

MOTIONLANG_BODY std::vector<std::byte> from_zlib(std::span<const std::byte> bytes, std::size_t limit,
                                                 const std::string& name) {
  ByteCount size;
  inflate_to(size, bytes.subspan(2), limit, name);
  Inflated unpacked = inflate(bytes.subspan(2), limit, name, size.bytes);
  const auto said = __builtin_bswap32(load<std::uint32_t>(bytes, 2 + unpacked.consumed, name, "a checksum"));
  if (const std::uint32_t sum = adler32(unpacked.data); sum != said)
    raise<io_error>(403, name, ": checksum ", sum, ", the file says ", said);
  return std::move(unpacked.data);
}

/// Throws as gunzip, and io_error 405 if the file declares more than `limit` bytes.
inline std::vector<std::byte> from_gzip(std::span<const std::byte> bytes, std::size_t limit, const std::string& name) {
  const auto size = load<std::uint32_t>(bytes, bytes.size() - std::min<std::size_t>(bytes.size(), 4), name, "a size");
  if (size > limit) raise<io_error>(405, name, ": declares ", counted(size, "byte"), ", may give ", limit);
  return gunzip_bytes(bytes, name);
}

/// The name of a packer that is not supported here; empty for other bytes.
inline std::string_view unread_packing(std::string_view text) {
  using namespace std::string_view_literals;
  constexpr std::pair<std::string_view, std::string_view> marks[] = {{"BZh"sv, "bzip2"},
                                                                     {"\xFD"
                                                                      "7zXZ\0"sv,
                                                                      "xz"},
                                                                     {"\x5D\0\0"sv, "lzma"},
                                                                     {"\x04\x22\x4D\x18"sv, "lz4"},
                                                                     {"\x28\xB5\x2F\xFD"sv, "zstd"}};
  for (const auto& [mark, name] : marks) {
    if (text.starts_with(mark)) return name;
  }
  return "";
}

/// True if bytes begin with the length of a header that they can hold, and with its brace.
inline bool is_safetensors(std::span<const std::byte> bytes) {
  const std::string_view text = as_text(bytes);
  return text.size() > 8 && text[8] == '{' && load<std::uint64_t>(bytes, 0, "", "") <= text.size() - 8;
}

/// True if the first value is the length of a header that the file holds, and is not too long.
inline bool has_header_length(std::span<const std::byte> bytes) {
  if (bytes.size() < sizeof(std::uint64_t)) return false;
  const auto length = load<std::uint64_t>(bytes, 0, "", "");
  return length <= SafetensorsFile::max_header && length <= bytes.size() - sizeof length;
}

/// True if bytes begin like a file of weights in a binary format, or with a zero byte in them, which no text has.
inline bool begins_weights(std::span<const std::byte> bytes) {
  const std::string_view text = as_text(bytes);
  // a wrong length
  const bool damaged = text.size() > 8 && text[8] == '{' && (text[7] == '\0' || !is_utf8(text.substr(0, 8)));
  return is_safetensors(bytes) || damaged || text.starts_with("PK\x03\x04") || text.starts_with("\x93NUMPY") ||
         text.starts_with('\x80') || is_zlib(bytes) || is_gzip(bytes) || text.substr(0, 4096).find('\0') != text.npos;
}

/// True if the bytes can begin a pickle: its protocol, or in protocols 0 and 1 an opcode that makes a container or a
/// name.
inline bool begins_pickle(std::string_view text) {
  if (text.empty()) return false;
  if (text[0] == '\x80') return text.size() > 1 && text[1] >= 1 && text[1] <= 5;
  return std::string_view("(c]}").find(text[0]) != std::string_view::npos;
}

}  // namespace detail

MOTIONLANG_BODY WeightFile WeightFile::from_safetensors(const SafetensorsFile& file) {
  WeightFile out(file.name(), file.owner(), "safetensors");
  out.tensors_.assign(file.tensors().begin(), file.tensors().end());
  for (const auto& [key, text] : file.metadata()) out.values_.push_back({key, text});
  return out;
}

MOTIONLANG_BODY WeightFile WeightFile::from_bytes(std::span<const std::byte> bytes, std::string name,
                                                  std::shared_ptr<const void> owner, const WeightOptions& options) {
  const std::string_view text = detail::as_text(bytes);
  constexpr std::size_t safetensors_start = 8;
  const auto refuse_keys = [&](const char* format) {
    if (options.path && !options.path->empty())
      raise<io_error>(406, name, ": no entry '", *options.path, "': ", format, " has no dictionaries");
  };
  const bool brace = text.size() > safetensors_start && text[safetensors_start] == '{';
  const bool by_chance = detail::is_zlib(bytes) && !detail::is_safetensors(bytes);  // packed bytes may be a brace
  if (brace && !by_chance) {
    refuse_keys("safetensors");
    return from_safetensors(SafetensorsFile::from_bytes(bytes, std::move(name), std::move(owner)));
  }
  const auto memory = std::make_shared<TensorMemory>(std::move(owner), bytes.size(), name);
  WeightFile out(name, memory, "");
  detail::WeightReader reader(out, *memory, options, bytes.size());
  const auto read_torch = [&](const TorchFile& file) {
    out.format_ = file.format();
    reader.read(file);
    if (out.tensors_.empty() && !out.skipped_.empty())
      raise<io_error>(406, name, ": no tensors that can be read in this ", out.format_,
                      "; skipped: ", to_string(out.skipped_.front()),
                      " (of a whole module or model, save its state_dict())");
    if (out.tensors_.empty()) raise<io_error>(406, name, ": no tensors in this ", out.format_);
    if (file.bytes_behind() > 0)
      out.skipped_.push_back({"", concat_text(counted(file.bytes_behind(), "byte"), " behind the end of data.pkl")});
  };
  if (text.starts_with("PK\x03\x04")) {
    const ZipArchive zip(bytes, name);
    if (!TorchFile::root_folder(zip).empty()) {
      read_torch(TorchFile::from_archive(zip, memory, options.checksums));
    } else {
      const NpzArchive npz(zip);
      if (npz.names().empty())
        raise<io_error>(403, name, ": a zip archive without data.pkl (PyTorch) and .npy (NumPy)");
      refuse_keys("npz");
      out.format_ = "npz";
      memory->allow(bytes.size() + (std::uint64_t{28} << 20));  // the needs of a pickle
      reader.read(npz, zip);
    }
  } else if (TorchFile::is_legacy(bytes)) {
    read_torch(TorchFile::from_legacy(bytes, name, memory));
  } else if (text.starts_with("\x93NUMPY")) {
    refuse_keys("npy");
    out.format_ = "npy";
    reader.read_npy(bytes);
  } else if (text.size() > 262 && text.substr(257, 5) == "ustar") {
    raise<io_error>(404, name, ": a tar archive, as PyTorch wrote them before 0.1.10");
  } else if (const auto packed = detail::unread_packing(text); !packed.empty()) {
    raise<io_error>(404, name, ": packed with ", packed, ", which is not read: unpack it first");
  } else if (detail::is_zlib(bytes) || is_gzip(bytes)) {
    // The memory that any pickle may need for its values. With it, and 10 MiB that are not counted, the limit is twice
    // the size and 64 MiB.
    constexpr std::uint64_t values = std::uint64_t{24} << 20;
    memory->allow(bytes.size() + (std::uint64_t{18} << 20));
    const std::vector<std::byte>& unpacked =
        memory->keep(is_gzip(bytes) ? detail::from_gzip(bytes, memory->left(), name)
                                    : detail::from_zlib(bytes, memory->left(), name));
    memory->spend(unpacked.size());
    const std::uint64_t most = values + std::min<std::uint64_t>(bytes.size(), memory->left());
    Pickle pickle(unpacked, name, {.max_memory = most, .inline_bytes = joblib_array_bytes});
    memory->spend(std::max(values, most - pickle.memory_left()) - values);
    read_torch(TorchFile::from_pickle(std::move(pickle), memory));
  } else if (detail::begins_pickle(text)) {
    Pickle pickle(bytes, name, {.inline_bytes = joblib_array_bytes});
    // of 8 bytes or more
    const bool number = pickle.root().is(PickleKind::integer) || pickle.root().is(PickleKind::bytes);
    if (number && pickle.end() < bytes.size() && bytes[static_cast<std::size_t>(pickle.end())] == std::byte{0x80})
      pickle.root().fail(404, "not the magic number of PyTorch's older files, although pickles follow it,");
    read_torch(TorchFile::from_pickle(std::move(pickle), memory));
  } else if (detail::has_header_length(bytes)) {
    refuse_keys("safetensors");
    return from_safetensors(SafetensorsFile::from_bytes(bytes, std::move(name), std::move(owner)));
  } else if (text.size() < safetensors_start) {
    raise<io_error>(402, name, ": ", counted(text.size(), "byte is", "bytes are"),
                    " not a file of weights of any kind");
  } else {
    raise<io_error>(404, name, ": not a file of weights: neither safetensors, PyTorch, NumPy, nor a pickle");
  }
  out.sort_tensors();
  return out;
}

MOTIONLANG_BODY void WeightFile::add(const WeightFile& file, const std::string& prefix,
                                     std::vector<std::shared_ptr<const void>>& owners) {
  owners.push_back(file.owner());
  files_.insert(files_.end(), file.files_.begin(), file.files_.end());
  for (TensorView t : file.tensors()) {
    if (!prefix.empty()) t.name = t.name == "array" ? prefix : prefix + "." + t.name;
    tensors_.push_back(std::move(t));
  }
  for (const FileValue& v : file.values())
    values_.push_back({prefix.empty() ? v.path : prefix + "/" + v.path, v.value});
  for (const SkippedValue& v : file.skipped())
    skipped_.push_back({prefix.empty() ? v.path : prefix + "/" + v.path, v.type});
}

/// The files that "weight_map" of an index.json names, each with its listed tensors.
MOTIONLANG_BODY WeightFile WeightFile::from_shards(const FilePath& index, const WeightOptions& options) {
  const auto document = read_json(index);
  const auto map = JsonView(document, index.string())["weight_map"].as<std::map<std::string, std::string>>();
  if (map.empty()) raise<io_error>(406, index.string(), ": weight_map names no tensors");
  const auto owners = std::make_shared<std::vector<std::shared_ptr<const void>>>();
  WeightFile out(index.string(), owners, "shards");
  std::map<std::string, std::vector<std::string>> files;
  for (const auto& [tensor, file] : map) files[file].push_back(tensor);
  const auto folder = std::filesystem::path(index.string()).parent_path();
  out.files_.emplace_back(index.string());
  for (const auto& [name, tensors] : files) {
    if (name.empty() || name == ".." || name.find_first_of(std::string_view("/\\\0", 3)) != name.npos)
      raise<io_error>(403, index.string(), ": '", name, "' is not a name of a file in the same folder");
    const auto bytes = MappedFile::open(folder / name);
    const WeightFile shard = from_bytes(bytes->bytes(), (folder / name).string(), bytes, options);
    owners->push_back(shard.owner());
    out.files_.push_back(folder / name);
    for (const std::string& tensor : tensors) out.tensors_.push_back(shard.tensor(tensor));
    out.skipped_.insert(out.skipped_.end(), shard.skipped().begin(), shard.skipped().end());
  }
  out.sort_tensors();
  return out;
}

/// The files of a training run: its weights under their own names, parts and statistics (TMR's
/// last_weights/motion_encoder.pt, stats/mean.pt) behind the name of the part: "motion_encoder.tokens", "stats.mean".
MOTIONLANG_BODY WeightFile WeightFile::from_run(const RunFolder& run, const WeightOptions& options) {
  if (run.weights.empty() && run.parts.empty())
    raise<io_error>(404, run.folder.string(), ": no weights in this folder (.pt, .ckpt, .tar, .safetensors)");
  if (run.parts.empty() && (run.system.empty() || run.system == "motionlang" || run.system == "hugging face"))
    return open_weights(run.weights, options);
  const KnownSystem* const known = known_system(run.system);
  std::string format = known == nullptr ? "folder" : concat_text(known->title, " run folder");
  const auto owners = std::make_shared<std::vector<std::shared_ptr<const void>>>();
  WeightFile out(run.folder.string(), owners, std::move(format));
  if (!run.weights.empty()) out.add(open_weights(run.weights, options), "", *owners);
  const WeightOptions own{.path = run.weights.empty() ? options.path : std::nullopt, .strict = options.strict};
  for (const auto& [part, path] : run.parts) out.add(open_weights(path, own), part, *owners);
  out.sort_tensors();
  return out;
}

MOTIONLANG_BODY bool may_be_weights(const FilePath& path) {
  std::error_code ignored;
  return std::filesystem::is_directory(path.string(), ignored) ||
         detail::begins_weights(MappedFile::open(path)->bytes());
}

MOTIONLANG_BODY WeightFile open_weights(const FilePath& path, const WeightOptions& options) {
  std::error_code ignored;
  if (std::filesystem::is_directory(path.string(), ignored)) return WeightFile::from_run(find_run(path), options);
  if (path.string().ends_with(".index.json")) return WeightFile::from_shards(path, options);
  const auto file = MappedFile::open(path);
  WeightFile out = WeightFile::from_bytes(file->bytes(), path.string(), file, options);
  out.files_.emplace_back(path.string());
  return out;
}

MOTIONLANG_NAMESPACE_END
