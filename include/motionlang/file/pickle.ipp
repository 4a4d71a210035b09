// SPDX-License-Identifier: MIT
// Bodies of pickle.hpp.
#pragma once

#include <motionlang/file/detail/pickle_machine.hpp>
#include <motionlang/file/pickle.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY const std::string& PickleValue::file() const { return machine_->file(); }

MOTIONLANG_BODY std::int64_t PickleValue::integer() const {
  if (!is(PickleKind::integer) && !is(PickleKind::boolean)) wrong("a whole number");
  return node().integer;
}

MOTIONLANG_BODY bool PickleValue::boolean() const {
  if (!is(PickleKind::boolean)) integer();
  return node().integer != 0;
}

MOTIONLANG_BODY std::string_view PickleValue::text() const {
  if (!is(PickleKind::text) && !is(PickleKind::bytes)) wrong("a text");
  return node().text;
}

MOTIONLANG_BODY std::span<const std::byte> PickleValue::bytes() const {
  if (!is(PickleKind::bytes)) wrong("bytes");
  return std::as_bytes(std::span(node().text.data(), node().text.size()));
}

MOTIONLANG_BODY PickleValue PickleValue::operator[](std::size_t i) const {
  if (node().keyed || i >= node().items.size()) wrong("a sequence of more elements");
  return {*machine_, node().items[i]};
}

MOTIONLANG_BODY std::optional<PickleValue> PickleValue::find(std::string_view name) const {
  for (std::size_t i = node().keyed ? size() : 0; i-- > 0;) {
    const PickleValue k = key(i);
    if ((k.is(PickleKind::text) || k.is(PickleKind::bytes)) && k.text() == name) return value(i);
  }
  return std::nullopt;
}

MOTIONLANG_BODY PickleValue PickleValue::operator[](std::string_view name) const {
  const auto found = find(name);
  if (!found) raise<io_error>(406, machine_->file(), ": no entry '", name, "' in the dictionary at byte ", at());
  return *found;
}

MOTIONLANG_BODY std::string PickleValue::name() const {
  if (is(PickleKind::name)) return concat_text(node().text, ".", node().attribute);
  if (!is(PickleKind::object)) return "";
  return machine_->node(node().callee).kind == PickleKind::name ? PickleValue(*machine_, node().callee).name() : "";
}

MOTIONLANG_BODY std::span<const std::byte> PickleValue::inline_bytes() const {
  if (!is(PickleKind::object)) wrong("an object with bytes behind it");
  return std::as_bytes(std::span(node().text.data(), node().text.size()));
}

MOTIONLANG_BODY const detail::PickleNode& PickleValue::node() const { return machine_->node(ref_); }

MOTIONLANG_BODY void PickleValue::fail_with(int id, const std::string& what) const {
  raise<io_error>(id, machine_->file(), ": ", what, machine_->place(at()));
}

MOTIONLANG_BODY void PickleValue::wrong(const char* expected) const {
  const std::string n = name();
  fail(407, expected, " expected, found ", to_string(kind()), n.empty() ? "" : " ", n);
}

MOTIONLANG_BODY PickleValue PickleValue::entry(std::size_t i) const {
  if (!node().keyed || i >= node().items.size()) wrong("a dictionary of more entries");
  return {*machine_, node().items[i]};
}

MOTIONLANG_BODY PickleValue PickleValue::related(detail::PickleRef ref, const char* what) const {
  if (ref == detail::no_pickle_value) wrong(what);
  return {*machine_, ref};
}

namespace detail {

inline void PickleMachine::read_inline(PickleRef object) {
  const InlineBytes found = options_.inline_bytes(PickleValue(*this, object), bytes_, position_);
  if (found.begin == 0) return;
  nodes_[object].text = as_text(slice(bytes_, found.begin, found.size, file_, "bytes behind an object"));
  position_ = found.begin + found.size;
}

}  // namespace detail

MOTIONLANG_BODY Pickle::Pickle(std::span<const std::byte> bytes, std::string file, const PickleOptions& options,
                               std::shared_ptr<const void> owner, std::uint64_t start)
    : machine_(std::make_unique<detail::PickleMachine>(bytes, std::move(file), options)), owner_(std::move(owner)) {
  root_ = machine_->run(start);
}

MOTIONLANG_BODY Pickle::Pickle(Pickle&&) noexcept = default;
MOTIONLANG_BODY Pickle& Pickle::operator=(Pickle&&) noexcept = default;
MOTIONLANG_BODY Pickle::~Pickle() = default;

MOTIONLANG_BODY Pickle Pickle::open(const FilePath& path, const PickleOptions& options) {
  auto file = MappedFile::open(path);
  return Pickle(file->bytes(), path.string(), options, file);
}

MOTIONLANG_BODY std::vector<PickleValue> Pickle::persistent() const {
  std::vector<PickleValue> out;
  for (const detail::PickleRef ref : machine_->persistent()) out.push_back({*machine_, ref});
  return out;
}

MOTIONLANG_BODY std::uint64_t Pickle::memory_left() const { return machine_->memory_left(); }

MOTIONLANG_BODY std::uint64_t Pickle::end() const { return machine_->position(); }

MOTIONLANG_NAMESPACE_END
