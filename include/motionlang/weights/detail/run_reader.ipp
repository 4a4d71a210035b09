// SPDX-License-Identifier: MIT
// Bodies of run_reader.hpp.
#pragma once

#include <algorithm>  // any_of, find

#include <motionlang/weights/detail/run_reader.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

MOTIONLANG_BODY std::filesystem::path folder_around(const std::filesystem::path& folder) {
  auto own = folder.lexically_normal();
  if (!own.has_filename()) own = own.parent_path();
  return own == "." || own.filename() == ".." ? own / ".." : own.parent_path();
}

MOTIONLANG_BODY Index RunReader::size(const std::string& name, int axis) const {
  const TensorView& t = weights_->tensor(prefix_ + name);
  if (axis >= t.shape.rank() || t.shape.count() < 1)
    raise<io_error>(407, weights_->name(), ": tensor '", t.name, "' is ", t.shape);
  return t.shape[axis];
}

MOTIONLANG_BODY Index RunReader::size(const std::string& name, int axis,
                                      std::initializer_list<const char*> options) const {
  const Index found = size(name, axis);
  for (const char* key : options) {
    const std::optional<Index> stated = whole(key);
    if (stated && *stated != found)
      raise<config_error>(102, place(key), " is ", *stated, ", tensor '", prefix_, name, "' in ", weights_->name(),
                          " is ", weights_->tensor(prefix_ + name).shape);
  }
  return found;
}

MOTIONLANG_BODY Index RunReader::size_if_any(const std::string& name, int axis,
                                             std::initializer_list<const char*> options) const {
  const bool none =
      !has(name) && std::any_of(options.begin(), options.end(), [&](const char* key) { return whole(key) == 0; });
  return none ? 0 : size(name, axis, options);
}

MOTIONLANG_BODY Index RunReader::count(const std::string& before, const std::string& behind,
                                       std::initializer_list<const char*> options) const {
  Index n = 0;
  while (has(concat_text(before, n, behind))) ++n;
  for (const char* key : options) {
    if (const auto stated = whole(key); stated && *stated != n)
      raise<config_error>(102, place(key), " is ", *stated, ", ", weights_->name(), " has ", n, " of '", prefix_,
                          before, "#", behind, "'");
  }
  if (n == 0) weights_->tensor(concat_text(prefix_, before, 0, behind));  // throws
  return n;
}

MOTIONLANG_BODY Index RunReader::number(std::initializer_list<const char*> keys, Index otherwise, Index largest,
                                        Index smallest) const {
  for (const char* key : keys) {
    const std::optional<Index> n = whole(key);
    if (!n) continue;
    if (*n < smallest || *n > largest)
      raise<config_error>(101, place(key), " is ", *n, ", not ", smallest, " ... ", largest);
    return *n;
  }
  return otherwise;
}

MOTIONLANG_BODY double RunReader::real(const char* key, double otherwise) const {
  const FileValue* v = run_->option(key);
  if (v == nullptr) return otherwise;
  if (const auto* d = std::get_if<double>(&v->value)) return *d;
  if (const auto* n = std::get_if<std::int64_t>(&v->value)) return static_cast<double>(*n);
  wrong_kind(key, "a number", *v);
}

MOTIONLANG_BODY bool RunReader::flag(const char* key, bool otherwise) const {
  const FileValue* v = run_->option(key);
  if (v == nullptr) return otherwise;
  if (const auto* b = std::get_if<bool>(&v->value)) return *b;
  wrong_kind(key, "true or false", *v);
}

MOTIONLANG_BODY std::string RunReader::text(const char* key, const char* otherwise) const {
  const FileValue* v = run_->option(key);
  return v == nullptr ? otherwise : to_string(*v);
}

MOTIONLANG_BODY std::string RunReader::one_of(const char* key, const char* otherwise,
                                              std::initializer_list<std::string_view> known) const {
  std::string found = text(key, otherwise);
  if (std::find(known.begin(), known.end(), found) != known.end()) return found;
  raise<io_error>(404, place(key), " is '", found, "', expected ", join_text(known, " or "));
}

MOTIONLANG_BODY std::optional<Index> RunReader::whole(const char* key) const {
  const FileValue* v = run_->option(key);
  if (v == nullptr) return std::nullopt;
  if (const auto* n = std::get_if<std::int64_t>(&v->value)) return static_cast<Index>(*n);
  if (const auto* d = std::get_if<double>(&v->value); d != nullptr && std::abs(*d) < 1e9 && *d == std::trunc(*d))
    return static_cast<Index>(*d);
  wrong_kind(key, "a whole number", *v);
}

MOTIONLANG_BODY void RunReader::wrong_kind(const char* key, const char* wanted, const FileValue& v) const {
  raise<config_error>(107, place(key), " is '", to_string(v), "', not ", wanted);
}

MOTIONLANG_BODY RunReader reader_of(const RunFolder& run, const TensorSet& weights, std::string_view name) {
  const auto prefix = prefix_of(weights, name);
  if (!prefix) raise<io_error>(406, weights.name(), ": no tensor '", name, "', with or without a prefix");
  return RunReader(run, weights, *prefix);
}

MOTIONLANG_BODY WeightFile statistics_of(const RunFolder& run) {
  RunFolder only = run;
  only.weights.clear();
  only.system.clear();
  return WeightFile::from_run(only);
}

MOTIONLANG_BODY Statistics find_statistics(const TensorSet& file, Index width,
                                           std::initializer_list<const char*> prefixes) {
  for (const std::string prefix : prefixes) {
    const TensorView *mean = file.find(prefix + "mean"), *std = file.find(prefix + "std");
    if (mean == nullptr || std == nullptr) continue;
    for (const TensorView* t : {mean, std}) {
      if (t->shape.count() != width)
        raise<io_error>(407, file.name(), ": tensor '", t->name, "' is ", t->shape, ", the model has ",
                        counted(width, "feature"));
    }
    return {mean, std};
  }
  return {};
}

MOTIONLANG_BODY void raise_no_statistics(const RunFolder& folder, std::string_view missing) {
  raise<io_error>(401, folder.folder.string(), ": no statistics of ", missing);
}

}  // namespace detail

MOTIONLANG_NAMESPACE_END
