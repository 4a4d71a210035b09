// SPDX-License-Identifier: MIT
/// The stack machine of a pickle: reads opcodes and gives a graph of inert values. It calls and imports nothing.
#pragma once

#include <algorithm>      // find
#include <deque>          // unescaped texts: views to them stay valid
#include <span>           // file
#include <string>         // messages
#include <string_view>    // texts in the file
#include <unordered_map>  // memo
#include <utility>        // opcodes and their names
#include <vector>         // stack

#include <motionlang/core/standard_library.hpp>
#include <motionlang/core/utf8.hpp>
#include <motionlang/file/detail/bytes.hpp>
#include <motionlang/file/detail/pickle_node.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

// clang-format off
/// The name of an opcode as in pickletools; empty if it is unknown.
inline std::string_view opcode_name(unsigned char opcode) {
  constexpr std::pair<unsigned char, std::string_view> names[] = {
      {'(', "MARK"}, {')', "EMPTY_TUPLE"}, {'.', "STOP"}, {'0', "POP"}, {'1', "POP_MARK"}, {'2', "DUP"}, {'B', "BINBYTES"},
      {'C', "SHORT_BINBYTES"}, {'F', "FLOAT"}, {'G', "BINFLOAT"}, {'I', "INT"}, {'J', "BININT"}, {'K', "BININT1"}, {'L', "LONG"},
      {'M', "BININT2"}, {'N', "NONE"}, {'P', "PERSID"}, {'Q', "BINPERSID"}, {'R', "REDUCE"}, {'S', "STRING"}, {'T', "BINSTRING"},
      {'U', "SHORT_BINSTRING"}, {'V', "UNICODE"}, {'X', "BINUNICODE"}, {']', "EMPTY_LIST"}, {'a', "APPEND"}, {'b', "BUILD"},
      {'c', "GLOBAL"}, {'d', "DICT"}, {'e', "APPENDS"}, {'g', "GET"}, {'h', "BINGET"}, {'i', "INST"}, {'j', "LONG_BINGET"},
      {'l', "LIST"}, {'o', "OBJ"}, {'p', "PUT"}, {'q', "BINPUT"}, {'r', "LONG_BINPUT"}, {'s', "SETITEM"}, {'t', "TUPLE"},
      {'u', "SETITEMS"}, {'}', "EMPTY_DICT"}, {0x80, "PROTO"}, {0x81, "NEWOBJ"}, {0x82, "EXT1"}, {0x83, "EXT2"}, {0x84, "EXT4"},
      {0x85, "TUPLE1"}, {0x86, "TUPLE2"}, {0x87, "TUPLE3"}, {0x88, "NEWTRUE"}, {0x89, "NEWFALSE"}, {0x8A, "LONG1"}, {0x8B, "LONG4"},
      {0x8C, "SHORT_BINUNICODE"}, {0x8D, "BINUNICODE8"}, {0x8E, "BINBYTES8"}, {0x8F, "EMPTY_SET"}, {0x90, "ADDITEMS"},
      {0x91, "FROZENSET"}, {0x92, "NEWOBJ_EX"}, {0x93, "STACK_GLOBAL"}, {0x94, "MEMOIZE"}, {0x95, "FRAME"}, {0x96, "BYTEARRAY8"},
      {0x97, "NEXT_BUFFER"}, {0x98, "READONLY_BUFFER"}};
  for (const auto& [code, name] : names) {
    if (code == opcode) return name;
  }
  return "";
}
// clang-format on

class PickleMachine {
 public:
  PickleMachine(std::span<const std::byte> bytes, std::string file, const PickleOptions& options)
      : bytes_(bytes), file_(std::move(file)), options_(options) {
    budget_ = std::min<std::uint64_t>(options_.max_values, 16 + 2 * std::uint64_t{bytes.size()});
    memory_ = options_.max_memory != 0 ? options_.max_memory : (std::uint64_t{24} << 20) + bytes.size();
  }

  const std::string& file() const { return file_; }
  const PickleNode& node(PickleRef ref) const { return nodes_[ref]; }
  std::uint64_t position() const { return position_; }
  std::uint64_t memory_left() const { return memory_; }
  /// Values that represent something outside of the pickle, in the order of the file.
  const std::vector<PickleRef>& persistent() const { return persistent_; }
  /// For messages: " at byte 7 (BINGET)".
  std::string place(std::uint64_t at) const {
    const auto name =
        at < bytes_.size() ? opcode_name(std::to_integer<unsigned char>(bytes_[static_cast<std::size_t>(at)])) : "";
    return name.empty() ? concat_text(" at byte ", at) : concat_text(" at byte ", at, " (", name, ")");
  }

  /// Reads from `start` to STOP and returns the value on the stack.
  PickleRef run(std::uint64_t start) {
    position_ = start;
    for (;;) {
      opcode_at_ = position_;
      const auto opcode = static_cast<unsigned char>(number<std::uint8_t>("opcode"));
      if (opcode == '.') return pop();
      execute(opcode);
    }
  }

 private:
  static constexpr std::size_t max_stack = 1'000'000, max_marks = 100'000, max_line = 65536, max_digits = 1024;

  template <class... T>
  [[noreturn]] void fail(int id, const T&... what) const {
    raise<io_error>(id, file_, ": pickle: ", what..., place(opcode_at_));
  }

  // The file.

  std::uint64_t left() const { return bytes_.size() - std::min<std::uint64_t>(position_, bytes_.size()); }
  template <class T>
  T number(std::string_view what) {
    if (left() < sizeof(T)) fail(402, "ends inside ", what);
    const T value = load<T>(bytes_, position_, file_, what);
    position_ += sizeof(T);
    return value;
  }
  std::string_view take(std::uint64_t size, std::string_view what) {
    if (left() < size) fail(402, what, " of ", counted(size, "byte"), " where ", left(), " are left");
    const auto part = slice(bytes_, position_, size, file_, what);
    position_ += size;
    return as_text(part);
  }
  /// The text up to the end of the line, which is skipped.
  std::string_view line(std::size_t longest) {
    const std::string_view rest = as_text(bytes_.subspan(static_cast<std::size_t>(position_)));
    const std::size_t end = rest.substr(0, longest).find('\n');
    if (end == std::string_view::npos) {
      fail(rest.size() > longest ? 405 : 402, "a line without end");
    }
    position_ += end + 1;
    const std::string_view text = rest.substr(0, end);
    return text.ends_with('\r') ? text.substr(0, end - 1) : text;
  }
  std::string_view keep(std::string text) {
    spend(sizeof(std::string) + text.size());
    return owned_.emplace_back(std::move(text));
  }

  // The stack. Marks are positions in it. Everything below the last mark is out of reach.

  void charge(std::size_t count) {
    if (count > budget_) fail(405, "more values than a file of ", counted(bytes_.size(), "byte"), " may have");
    budget_ -= count;
    spend(count * 2 * sizeof(PickleRef));
  }
  void spend(std::uint64_t bytes) {
    if (bytes > memory_) fail(405, "more memory than a file of ", counted(bytes_.size(), "byte"), " may need");
    memory_ -= bytes;
  }
  PickleRef add(PickleKind kind) {
    charge(1);
    spend(sizeof(PickleNode));
    nodes_.push_back({});
    nodes_.back().kind = kind;
    nodes_.back().at = opcode_at_;
    return static_cast<PickleRef>(nodes_.size() - 1);
  }
  void push(PickleRef ref) {
    if (stack_.size() >= max_stack) fail(405, "more than ", max_stack, " values on the stack");
    stack_.push_back(ref);
  }
  PickleNode& push_new(PickleKind kind) {
    push(add(kind));
    return nodes_.back();
  }
  std::size_t floor() const { return marks_.empty() ? 0 : marks_.back(); }
  PickleRef top() const {
    if (stack_.size() <= floor()) fail(403, "nothing on the stack");
    return stack_.back();
  }
  PickleRef pop() {
    const PickleRef ref = top();
    stack_.pop_back();
    return ref;
  }
  PickleNode& pop_node(PickleKind kind) {
    PickleNode& n = nodes_[pop()];
    if (n.kind != kind) fail(403, name_of(kind), " expected on the stack, found ", name_of(n.kind));
    return n;
  }
  /// Values above the last mark. The mark is removed, too.
  std::vector<PickleRef> pop_marked() {
    if (marks_.empty()) fail(403, "no mark on the stack");
    const auto first = stack_.begin() + static_cast<std::ptrdiff_t>(marks_.back());
    std::vector<PickleRef> items(first, stack_.end());
    stack_.erase(first, stack_.end());
    marks_.pop_back();
    return items;
  }
  std::vector<PickleRef> pop_some(std::size_t count) {
    std::vector<PickleRef> items(count);
    for (std::size_t i = count; i-- > 0;) items[i] = pop();
    return items;
  }

  // Values.

  void push_integer(std::int64_t value) { push_new(PickleKind::integer).integer = value; }
  void push_boolean(bool value) { push_new(PickleKind::boolean).integer = value ? 1 : 0; }
  void push_real(double value) { push_new(PickleKind::real).real = value; }
  void push_text(PickleKind kind, std::string_view text) { push_new(kind).text = text; }
  void push_items(PickleKind kind, std::vector<PickleRef> items) {
    charge(items.size());
    PickleNode& n = push_new(kind);
    n.keyed = kind == PickleKind::dict;
    if (n.keyed && items.size() % 2 != 0) fail(403, "a key without a value");
    n.items = std::move(items);
  }
  void add_items(bool keyed, const std::vector<PickleRef>& items) {
    PickleNode& n = nodes_[top()];
    const bool fits = keyed ? n.kind == PickleKind::dict : n.kind == PickleKind::list;
    const bool object = n.kind == PickleKind::object && (n.items.empty() || n.keyed == keyed);
    if (!fits && !object) fail(403, keyed ? "entries for " : "elements for ", name_of(n.kind));
    if (keyed && items.size() % 2 != 0) fail(403, "a key without a value");
    charge(items.size());
    n.keyed = keyed;
    n.items.insert(n.items.end(), items.begin(), items.end());
  }

  /// Little-endian two's complement of any length.
  void push_long(std::string_view digits) {
    if (digits.size() > 8) return push_text(PickleKind::bytes, digits);
    const bool negative = !digits.empty() && (digits.back() & 0x80) != 0;
    std::uint64_t value = negative ? ~std::uint64_t{0} : 0;
    for (std::size_t i = digits.size(); i-- > 0;) value = value << 8 | static_cast<unsigned char>(digits[i]);
    push_integer(static_cast<std::int64_t>(value));
  }
  template <class T>
  T parse(std::string_view digits, const char* what) {
    T value{};
    const char* const end = digits.data() + digits.size();
    const auto [stop, problem] = detail::from_chars(digits.data(), end, value);
    if (problem != std::errc() || stop != end) fail(403, "not ", what, ": '", digits, "'");
    return value;
  }
  void push_decimal(std::string_view digits) {
    if (digits.ends_with('L')) digits.remove_suffix(1);
    std::int64_t value = 0;
    const char* const end = digits.data() + digits.size();
    const auto [stop, problem] = detail::from_chars(digits.data(), end, value);
    if (problem == std::errc::invalid_argument || stop != end) fail(403, "not a whole number: '", digits, "'");
    if (problem != std::errc()) return push_text(PickleKind::text, digits);
    push_integer(value);
  }
  /// UTF-8, or with single surrogates, which Python writes as three bytes each.
  void push_utf8(std::string_view text) {
    for (std::size_t at = 0; at < text.size();) {
      const std::size_t start = at;
      if (decode_utf8(text, at) != invalid_code_point) continue;
      if (text[start] != '\xED' || start + 2 >= text.size()) fail(403, "a text that is not UTF-8");
      at = start + 3;
    }
    push_text(PickleKind::text, text);
  }

  static int hexadecimal(char c) {
    return c >= '0' && c <= '9'   ? c - '0'
           : c >= 'a' && c <= 'f' ? c - 'a' + 10
           : c >= 'A' && c <= 'F' ? c - 'A' + 10
                                  : -1;
  }
  /// The number in `count` hexadecimal digits from text[at].
  char32_t code(std::string_view text, std::size_t at, std::size_t count) {
    char32_t value = 0;
    for (std::size_t i = at; i < at + count; ++i) {
      const int digit = i < text.size() ? hexadecimal(text[i]) : -1;
      if (digit < 0) fail(403, "a damaged escape in a text");
      value = value << 4 | static_cast<char32_t>(digit);
    }
    return value;
  }
  /// 'text' in quotes, with the escapes of Python's repr.
  std::string unquoted(std::string_view text) {
    const bool quoted =
        text.size() >= 2 && text.front() == text.back() && (text.front() == '\'' || text.front() == '"');
    if (!quoted) fail(403, "a text without quotes");
    text = text.substr(1, text.size() - 2);
    constexpr std::string_view letters = "abfnrtv\\'\"", meanings = "\a\b\f\n\r\t\v\\'\"";
    std::string out;
    for (std::size_t i = 0; i < text.size(); ++i) {
      if (text[i] != '\\') {
        out += text[i];
        continue;
      }
      const char c = ++i < text.size() ? text[i] : '\0';
      if (const std::size_t k = letters.find(c); k != std::string_view::npos) {
        out += meanings[k];
      } else if (c == 'x') {
        out += static_cast<char>(code(text, i + 1, 2));
        i += 2;
      } else if (c >= '0' && c < '8') {
        unsigned value = 0;
        std::size_t end = i;
        for (; end < text.size() && end < i + 3 && text[end] >= '0' && text[end] < '8'; ++end) {
          value = value * 8 + static_cast<unsigned>(text[end] - '0');
        }
        out += static_cast<char>(value & 255u);
        i = end - 1;
      } else {
        fail(403, "a damaged escape in a text");
      }
    }
    return out;
  }
  /// Latin-1 with \uXXXX and \UXXXXXXXX.
  std::string raw_unicode(std::string_view text) {
    std::string out;
    for (std::size_t i = 0; i < text.size(); ++i) {
      const char next = i + 1 < text.size() ? text[i + 1] : '\0';
      char32_t c = static_cast<unsigned char>(text[i]);
      if (c == '\\' && (next == 'u' || next == 'U')) {
        const std::size_t digits = next == 'u' ? 4 : 8;
        c = code(text, i + 2, digits);
        if (c > 0x10FFFF) fail(403, "a damaged escape in a text");
        i += 1 + digits;
      }
      append_utf8(out, c);
    }
    return out;
  }

  // Names and calls.

  static bool executes(std::string_view module, std::string_view attribute) {
    constexpr std::string_view modules[] = {"os",    "posix",     "nt",  "subprocess", "sys",      "socket", "shutil",
                                            "runpy", "importlib", "pty", "ctypes",     "commands", "popen2", "code"};
    constexpr std::string_view builtins[] = {"eval",  "exec",       "execfile",  "compile", "open",
                                             "file",  "__import__", "getattr",   "setattr", "delattr",
                                             "apply", "input",      "breakpoint"};
    const std::string_view package = module.substr(0, module.find('.'));
    if (std::find(std::begin(modules), std::end(modules), package) != std::end(modules)) return true;
    return is_builtin(module) && std::find(std::begin(builtins), std::end(builtins), attribute) != std::end(builtins);
  }
  static bool is_builtin(std::string_view module) { return module == "__builtin__" || module == "builtins"; }
  bool allowed(std::string_view module, std::string_view attribute) const {
    const std::string name = concat_text(module, ".", attribute);
    return options_.allowed.empty() ||
           std::any_of(options_.allowed.begin(), options_.allowed.end(), [&](std::string_view pattern) {
             return pattern.ends_with('.') ? name.starts_with(pattern) : name == pattern;
           });
  }
  void push_name(std::string_view module, std::string_view attribute) {
    if (module.size() > max_line || attribute.size() > max_line) fail(405, "a name of more than ", max_line, " bytes");
    if (executes(module, attribute)) {
      fail(404, "names ", module, ".", attribute, ": the file tries to execute code");
    }
    if (!allowed(module, attribute)) fail(404, "names ", module, ".", attribute, ", which is not allowed here");
    PickleNode& n = push_new(PickleKind::name);
    n.text = module;
    n.attribute = attribute;
  }

  /// One byte for every code point of a text: the form in which Python 3 writes bytes in protocols 0 to 2. Each text is
  /// converted only once.
  std::string_view latin1(PickleRef ref) {
    const auto [slot, first] = latin1_.try_emplace(ref);
    if (!first) return slot->second;
    spend(sizeof(*slot) + 2 * sizeof(void*));
    const std::string_view text = nodes_[ref].text;
    std::string out;
    for (std::size_t at = 0; at < text.size();) {
      const char32_t c = decode_utf8(text, at);
      if (c > 255) fail(403, "bytes outside Latin-1");
      out += static_cast<char>(static_cast<unsigned char>(c));
    }
    return slot->second = keep(std::move(out));
  }

  /// Result of calling `callee`: a plain value for Python's own types, otherwise an object that remembers the call.
  void call(PickleRef callee, PickleRef arguments) {
    const std::string_view module = nodes_[callee].text, attribute = nodes_[callee].attribute;
    const bool named = nodes_[callee].kind == PickleKind::name;
    const std::vector<PickleRef>& given = nodes_[arguments].items;
    auto is_sequence = [&](PickleRef r) {
      return nodes_[r].kind == PickleKind::list || nodes_[r].kind == PickleKind::tuple;
    };
    if (named && module == "collections" && (attribute == "OrderedDict" || attribute == "defaultdict")) {
      if (attribute == "defaultdict" || given.empty()) return push_items(PickleKind::dict, {});
      if (given.size() == 1 && is_sequence(given[0])) return push_pairs(given[0]);
      fail(403, "arguments of collections.OrderedDict");
    }
    const bool encode = named && module == "_codecs" && attribute == "encode";
    const bool encoded = given.size() == 2 && nodes_[given[0]].kind == PickleKind::text &&
                         (nodes_[given[1]].text == "latin1" || nodes_[given[1]].text == "latin-1");
    if (encode && !encoded) fail(404, "an encoding other than Latin-1");
    if (named && is_builtin(module)) {
      const bool bytes = attribute == "bytes" || attribute == "bytearray";
      if (bytes && encoded) return push_bytes(given[0]);
      if (bytes && given.empty()) return push_text(PickleKind::bytes, {});
      const bool collection =
          attribute == "list" || attribute == "tuple" || attribute == "set" || attribute == "frozenset";
      if (collection && given.empty()) return push_items(PickleKind::list, {});
      if (collection && given.size() == 1 && is_sequence(given[0])) return push(given[0]);
      if (attribute == "bytearray" && given.size() == 1 && nodes_[given[0]].kind == PickleKind::bytes) {
        return push(given[0]);
      }
    }
    if (encode) return push_bytes(given[0]);
    const bool rebuilt = named && (module == "copy_reg" || module == "copyreg") && attribute == "_reconstructor";
    if (rebuilt && given.empty()) fail(403, "arguments of copyreg._reconstructor");
    const PickleRef made_by = rebuilt ? given[0] : callee;  // (class, base, state of the base)
    PickleNode& n = push_new(PickleKind::object);
    n.callee = made_by;
    n.arguments = arguments;
  }
  void push_bytes(PickleRef text) { push_text(PickleKind::bytes, latin1(text)); }
  void push_pairs(PickleRef list) {
    std::vector<PickleRef> items;
    for (const PickleRef pair : nodes_[list].items) {
      const std::vector<PickleRef>& entry = nodes_[pair].items;
      if (entry.size() != 2 || nodes_[pair].keyed) fail(403, "a pair of key and value expected");
      items.insert(items.end(), entry.begin(), entry.end());
    }
    push_items(PickleKind::dict, std::move(items));
  }

  void build() {
    const PickleRef state = pop();
    PickleNode& n = nodes_[top()];
    if (n.kind != PickleKind::object && n.kind != PickleKind::dict && n.kind != PickleKind::list) {
      fail(403, "a state for ", name_of(n.kind));
    }
    n.state = state;
    if (options_.inline_bytes != nullptr && n.kind == PickleKind::object) read_inline(top());
  }
  void read_inline(PickleRef object);  // in file/pickle.ipp: it needs PickleValue

  void put(std::uint64_t index) {
    const auto [slot, first] = memo_.try_emplace(index);
    if (first) spend(sizeof(*slot) + 2 * sizeof(void*));
    slot->second = top();
  }
  void get(std::uint64_t index) {
    const auto found = memo_.find(index);
    if (found == memo_.end()) fail(403, "memo ", index, " was never written");
    push(found->second);
  }
  void push_persistent(PickleRef id) {
    if (!options_.persistent_ids) fail(404, "a persistent id, which means something outside this file");
    const std::vector<PickleRef>& parts = nodes_[id].items;
    // PyTorch's older form refers to the source code of classes.
    if (!parts.empty() && nodes_[parts[0]].text == "module")
      fail(404, "a whole module with its source code, not its tensors: save its state_dict()");
    push_new(PickleKind::persistent).arguments = id;
    persistent_.push_back(stack_.back());
  }

  // clang-format off
  void execute(unsigned char opcode) {
    switch (opcode) {
      case 0x80: if (const int v = number<std::uint8_t>("protocol"); v > 5) fail(404, "protocol ", v); return;
      case 0x95: frame(number<std::uint64_t>("frame")); return;
      case '(': if (marks_.size() >= max_marks) fail(405, "too many marks"); marks_.push_back(stack_.size()); return;
      case '0': if (stack_.size() == floor() && !marks_.empty()) marks_.pop_back(); else pop(); return;
      case '1': pop_marked(); return;
      case '2': push(top()); return;

      case 'N': push_new(PickleKind::none); return;
      case 0x88: push_boolean(true); return;
      case 0x89: push_boolean(false); return;
      case 'K': push_integer(number<std::uint8_t>("integer")); return;
      case 'M': push_integer(number<std::uint16_t>("integer")); return;
      case 'J': push_integer(number<std::int32_t>("integer")); return;
      case 'I': {
        const std::string_view digits = line(max_digits);
        if (digits == "00" || digits == "01") return push_boolean(digits == "01");
        return push_decimal(digits);
      }
      case 'L': push_decimal(line(max_digits)); return;
      case 'F': push_real(parse<double>(line(max_digits), "a real number")); return;
      case 'G': push_real(detail::bit_cast<double>(__builtin_bswap64(number<std::uint64_t>("real number")))); return;
      case 0x8A: push_long(take(number<std::uint8_t>("length"), "integer")); return;
      case 0x8B: push_long(take(length(), "integer")); return;

      case 'X': push_utf8(take(number<std::uint32_t>("length"), "text")); return;
      case 0x8C: push_utf8(take(number<std::uint8_t>("length"), "text")); return;
      case 0x8D: push_utf8(take(number<std::uint64_t>("length"), "text")); return;
      case 'V': push_text(PickleKind::text, keep(raw_unicode(line(bytes_.size())))); return;
      case 'U': push_text(PickleKind::bytes, take(number<std::uint8_t>("length"), "text")); return;
      case 'T': push_text(PickleKind::bytes, take(length(), "text")); return;
      case 'S': push_text(PickleKind::bytes, keep(unquoted(line(bytes_.size())))); return;
      case 'C': push_text(PickleKind::bytes, take(number<std::uint8_t>("length"), "bytes")); return;
      case 'B': push_text(PickleKind::bytes, take(number<std::uint32_t>("length"), "bytes")); return;
      case 0x8E: case 0x96: push_text(PickleKind::bytes, take(number<std::uint64_t>("length"), "bytes")); return;

      case ')': push_items(PickleKind::tuple, {}); return;
      case 0x85: push_items(PickleKind::tuple, pop_some(1)); return;
      case 0x86: push_items(PickleKind::tuple, pop_some(2)); return;
      case 0x87: push_items(PickleKind::tuple, pop_some(3)); return;
      case 't': push_items(PickleKind::tuple, pop_marked()); return;
      case ']': case 0x8F: push_items(PickleKind::list, {}); return;
      case 'l': case 0x91: push_items(PickleKind::list, pop_marked()); return;
      case 'a': { const auto items = pop_some(1); return add_items(false, items); }
      case 'e': case 0x90: { const auto items = pop_marked(); return add_items(false, items); }
      case '}': push_items(PickleKind::dict, {}); return;
      case 'd': push_items(PickleKind::dict, pop_marked()); return;
      case 's': { const auto items = pop_some(2); return add_items(true, items); }
      case 'u': { const auto items = pop_marked(); return add_items(true, items); }

      case 'q': put(number<std::uint8_t>("memo")); return;
      case 'r': put(number<std::uint32_t>("memo")); return;
      case 'p': put(parse<std::uint64_t>(line(max_digits), "a memo number")); return;
      case 0x94: put(memo_.size()); return;
      case 'h': get(number<std::uint8_t>("memo")); return;
      case 'j': get(number<std::uint32_t>("memo")); return;
      case 'g': get(parse<std::uint64_t>(line(max_digits), "a memo number")); return;

      case 'c': { const std::string_view module = line(max_line); return push_name(module, line(max_line)); }
      case 0x93: {
        const std::string_view attribute = pop_node(PickleKind::text).text;
        return push_name(pop_node(PickleKind::text).text, attribute);
      }
      case 'R': case 0x81: {
        const PickleRef arguments = pop();
        return call_with_tuple(pop(), arguments);
      }
      case 0x92: {
        const PickleRef keywords = top();
        const bool none = pop_node(PickleKind::dict).items.empty();
        const PickleRef arguments = pop();
        return call_with_tuple(pop(), none ? arguments : with_last(arguments, keywords));
      }
      case 'i': {
        const std::string_view module = line(max_line);
        push_items(PickleKind::tuple, pop_marked());
        const PickleRef arguments = pop();
        push_name(module, line(max_line));
        return call_with_tuple(pop(), arguments);
      }
      case 'o': {
        std::vector<PickleRef> items = pop_marked();
        if (items.empty()) fail(403, "an object without a class");
        const PickleRef callee = items.front();
        items.erase(items.begin());
        push_items(PickleKind::tuple, std::move(items));
        return call_with_tuple(callee, pop());
      }
      case 'b': build(); return;
      case 'Q': push_persistent(pop()); return;
      case 'P': push_text(PickleKind::text, line(max_line)); push_persistent(pop()); return;

      case 0x82: case 0x83: case 0x84: case 0x97: case 0x98: fail(404, "an extension or a buffer outside the file");
      default: fail(403, "opcode ", int{opcode});
    }
  }
  // clang-format on

  void frame(std::uint64_t size) {
    if (left() < size) fail(402, "a frame of ", counted(size, "byte"), " where ", left(), " are left");
  }
  std::uint64_t length() {
    const auto n = number<std::int32_t>("length");
    if (n < 0) fail(403, "a negative length");
    return static_cast<std::uint64_t>(n);
  }
  /// A tuple with one more value. Keyword arguments follow the others.
  PickleRef with_last(PickleRef tuple, PickleRef last) {
    std::vector<PickleRef> items = nodes_[tuple].items;
    items.push_back(last);
    push_items(nodes_[tuple].kind, std::move(items));
    return pop();
  }
  void call_with_tuple(PickleRef callee, PickleRef arguments) {
    const PickleKind kind = nodes_[callee].kind;
    if (kind != PickleKind::name && kind != PickleKind::object) fail(403, "a call of ", name_of(kind));
    if (nodes_[arguments].kind != PickleKind::tuple) fail(403, "a call with ", name_of(nodes_[arguments].kind));
    call(callee, arguments);
  }

  std::span<const std::byte> bytes_;
  std::string file_;
  PickleOptions options_;
  std::uint64_t position_ = 0, opcode_at_ = 0, budget_ = 0, memory_ = 0;
  std::deque<PickleNode> nodes_;
  std::vector<PickleRef> stack_, persistent_;
  std::vector<std::size_t> marks_;
  std::unordered_map<std::uint64_t, PickleRef> memo_;
  std::unordered_map<PickleRef, std::string_view> latin1_;
  std::deque<std::string> owned_;
};

}  // namespace detail

MOTIONLANG_NAMESPACE_END
