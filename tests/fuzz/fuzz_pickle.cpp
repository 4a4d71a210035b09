// Pickles: any bytes are read or refused with an error of the library; what was read can be walked, and arrays in it
// hold as many bytes as their shape says.
#include <cstdint>

#include <motionlang/file/pickle_arrays.hpp>

#include "check.hpp"

namespace {

namespace ml = motionlang;

void check_array(const ml::PickleValue& v) {
  try {
    const ml::NpyArray a = ml::to_array(v);
    check(a.data.size() == static_cast<std::size_t>(a.count()) * a.item_size, "bytes of an array");
    if (!a.is_text()) check(std::ssize(a.to<double>()) == a.count(), "numbers of an array");
  } catch (const ml::error&) {}
}

/// Looks at a value and at what it consists of, as far as `budget` lasts.
void walk(const ml::PickleValue& v, int depth, int& budget) {
  if (depth > 50 || --budget < 0) return;
  if (v.is(ml::PickleKind::object)) check_array(v);
  if (v.is(ml::PickleKind::text) || v.is(ml::PickleKind::bytes)) {
    check(std::string(v.text()).size() == v.text().size(), "a text");
    return;
  }
  check(v.name().empty() || v.is(ml::PickleKind::name) || v.is(ml::PickleKind::object), "names of other values");
  if (v.is(ml::PickleKind::object)) walk(v.arguments(), depth + 1, budget);
  if (v.has_state()) walk(v.state(), depth + 1, budget);
  for (std::size_t i = 0; i < v.size(); ++i) {
    if (v.is(ml::PickleKind::dict)) walk(v.key(i), depth + 1, budget), walk(v.value(i), depth + 1, budget);
    if (v.is(ml::PickleKind::list) || v.is(ml::PickleKind::tuple)) walk(v[i], depth + 1, budget);
    if (budget < 0) return;
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    const ml::Pickle file(std::as_bytes(std::span(data, size)), "fuzz", {.persistent_ids = true});
    check(file.end() <= size, "end of the pickle");
    int budget = 300;
    walk(file.root(), 0, budget);
  } catch (const ml::error&) {}
  return 0;
}
