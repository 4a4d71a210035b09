// SPDX-License-Identifier: MIT
// Bodies of pickle_arrays.hpp.
#pragma once

#include <algorithm>  // any_of, is_sorted

#include <motionlang/file/pickle_arrays.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

inline bool is_numpy(const PickleValue& v, std::string_view function) {
  const std::string name = v.name();
  constexpr std::string_view modules[] = {"numpy.core.multiarray.", "numpy._core.multiarray.", "numpy.core.numeric.",
                                          "numpy._core.numeric.", "numpy."};
  return std::any_of(std::begin(modules), std::end(modules), [&](std::string_view module) {
    return name.starts_with(module) && std::string_view(name).substr(module.size()) == function;
  });
}

inline std::vector<Index> shape_of(const PickleValue& sizes) {
  std::vector<Index> shape;
  for (std::size_t i = 0; i < sizes.size(); ++i) {
    const std::int64_t n = sizes[i].integer();
    if (n < 0 || i >= 32) sizes.fail(403, "not the shape of an array");
    shape.push_back(static_cast<Index>(n));
  }
  return shape;
}

/// numpy.dtype('f8', False, True) with the state (3, '<', None, ...): "<f8".
inline std::string pickled_dtype(const PickleValue& v) {
  if (!is_numpy(v, "dtype")) v.fail(407, "an element type expected");
  std::string type(v.arguments()[0].text());
  if (type.starts_with('<') || type.starts_with('>') || type.starts_with('|')) return type;
  return concat_text(v.has_state() ? v.state()[1].text() : "=", type);
}

MOTIONLANG_BODY bool is_joblib_array(const PickleValue& v) {
  return v.name() == "joblib.numpy_pickle.NumpyArrayWrapper";
}

MOTIONLANG_BODY bool is_numpy_scalar(const PickleValue& v) { return is_numpy(v, "scalar"); }

MOTIONLANG_BODY bool is_numpy_array(const PickleValue& v) {
  return is_numpy(v, "_reconstruct") || is_numpy(v, "_frombuffer") || is_joblib_array(v);
}

MOTIONLANG_BODY PickledArray pickled_array(const PickleValue& v) {
  const std::string where = concat_text(v.file(), ": array at byte ", v.at());
  if (is_numpy(v, "_reconstruct")) {
    const PickleValue state = v.state();  // version, shape, element type, whether the first index is the fastest, bytes
    if (state[4].is(PickleKind::list)) v.fail(404, "an array of objects");
    return {pickled_dtype(state[2]), state[3].boolean(), shape_of(state[1]), state[4].bytes(), where};
  }
  if (is_joblib_array(v)) {
    const PickleValue state = v.state();
    return {pickled_dtype(state["dtype"]), state["order"].text() == "F", shape_of(state["shape"]), v.inline_bytes(),
            where};
  }
  const PickleValue given = v.arguments();
  if (is_numpy(v, "_frombuffer")) {  // bytes, element type, shape, order
    return {pickled_dtype(given[1]), given[3].text() == "F", shape_of(given[2]), given[0].bytes(), where};
  }
  return {pickled_dtype(given[0]), false, {}, given[1].bytes(), where};
}

inline NpyArray numpy_array(const PickleValue& v) {
  PickledArray a = pickled_array(v);
  return stored_array(a.type, a.fortran_order, std::move(a.shape), a.raw, a.where);
}

/// A sparse matrix in full. Compressed by columns (csc) or rows (csr): entries indptr[c] ... indptr[c + 1] - 1 lie in
/// column (row) c at row (column) indices[k]. As a list (coo): entry k at row[k], col[k], or in newer files at coords.
inline NpyArray dense_matrix(const PickleValue& v) {
  const std::string name = v.name();
  const std::string_view kind = std::string_view(name).substr(name.rfind('.') + 1);
  const bool by_column = kind == "csc_matrix" || kind == "csc_array",
             by_row = kind == "csr_matrix" || kind == "csr_array";
  if (!by_column && !by_row && kind != "coo_matrix" && kind != "coo_array")
    v.fail(404, "a sparse matrix of class ", name);
  const PickleValue state = v.state();
  const auto shape = shape_of(state.find("_shape") ? state["_shape"] : state["shape"]);
  constexpr Index most = 2'000'000;
  if (shape.size() != 2) v.fail(403, "a sparse matrix with ", counted(shape.size(), "size"));
  const Index rows = shape[0], columns = shape[1];
  if (rows > most || columns > most || rows * columns > most) {
    v.fail(405, "a sparse matrix of ", rows, " x ", columns, " is too large");
  }
  const auto data = numpy_array(state["data"]).to<double>();
  const auto places = [](const PickleValue& array) { return numpy_array(array).to<std::int64_t>(); };
  std::vector<std::int64_t> row, column;
  if (by_column || by_row) {
    const auto starts = places(state["indptr"]);
    if (std::ssize(starts) != (by_column ? columns : rows) + 1 || starts.front() != 0 ||
        starts.back() != std::ssize(data) || !std::is_sorted(starts.begin(), starts.end())) {
      v.fail(403, "a sparse matrix whose arrays do not fit together");
    }
    (by_column ? row : column) = places(state["indices"]);
    std::vector<std::int64_t>& outer = by_column ? column : row;
    for (std::size_t c = 0; c + 1 < starts.size(); ++c)
      outer.resize(static_cast<std::size_t>(starts[c + 1]), static_cast<std::int64_t>(c));
  } else {
    const auto both = state.find("coords");
    row = places(both ? (*both)[0] : state["row"]);
    column = places(both ? (*both)[1] : state["col"]);
  }
  if (row.size() != data.size() || column.size() != data.size())
    v.fail(403, "a sparse matrix whose arrays do not fit together");
  std::vector<double> dense(static_cast<std::size_t>(rows * columns), 0.0);
  for (std::size_t k = 0; k < data.size(); ++k) {
    if (row[k] < 0 || row[k] >= rows || column[k] < 0 || column[k] >= columns)
      v.fail(403, "entry ", row[k], ", ", column[k], " in a sparse matrix of ", rows, " x ", columns);
    dense[static_cast<std::size_t>(row[k] * columns + column[k])] += data[k];
  }
  return NpyArray::of(std::span<const double>(dense), {rows, columns});
}

inline NpyArray to_array(const PickleValue& v, int depth);

/// Select: a flattened, elements idxs of it, in the shape preferred_shape.
inline NpyArray selected_array(const PickleValue& v, int depth) {
  const PickleValue state = v.state();
  const auto values = to_array(state["a"], depth).to<double>();
  const auto indices = to_array(state["idxs"], depth).to<std::int64_t>();
  std::vector<double> out;
  for (const std::int64_t i : indices) {
    if (i < 0 || i >= std::ssize(values)) v.fail(403, "index ", i, " into ", counted(values.size(), "value"));
    out.push_back(values[static_cast<std::size_t>(i)]);
  }
  const auto preferred = state.find("preferred_shape");
  const bool has_shape = preferred && !preferred->is(PickleKind::none);
  auto shape = has_shape ? shape_of(*preferred) : std::vector<Index>{std::ssize(out)};
  if (static_cast<std::size_t>(checked_size(shape, 1, "chumpy")) != out.size()) {
    v.fail(403, counted(out.size(), "selected value"), " for another shape");
  }
  return NpyArray::of(std::span<const double>(out), std::move(shape));
}

/// Any other node of chumpy: its only value, called x or a.
inline NpyArray node_array(const PickleValue& v, int depth) {
  if (!v.has_state()) v.fail(404, "an array of class ", v.name());
  const auto x = v.state().find("x"), a = v.state().find("a");
  if (x.has_value() == a.has_value()) v.fail(404, "an array of class ", v.name());
  return to_array(x ? *x : *a, depth);
}

inline NpyArray to_array(const PickleValue& v, int depth) {
  constexpr int deepest = 32;
  if (depth > deepest) v.fail(405, "arrays in arrays, more than ", deepest, " deep");
  if (v.is(PickleKind::integer) || v.is(PickleKind::boolean)) return NpyArray::scalar(v.integer());
  if (v.is(PickleKind::real)) return NpyArray::scalar(v.real());
  if (is_numpy_array(v) || is_numpy_scalar(v)) return numpy_array(v);
  const std::string name = v.name();
  if (name.starts_with("scipy.sparse.")) return dense_matrix(v);
  if (name == "chumpy.reordering.Select") return selected_array(v, depth + 1);
  if (name.starts_with("chumpy.")) return node_array(v, depth + 1);
  v.fail(407, "an array expected, found ", name.empty() ? to_string(v.kind()) : name);
}

}  // namespace detail

MOTIONLANG_BODY InlineBytes joblib_array_bytes(const PickleValue& object, std::span<const std::byte> file,
                                               std::uint64_t position) {
  if (!detail::is_joblib_array(object)) return {};
  const PickleValue state = object.state();
  const auto alignment = state.find("numpy_array_alignment_bytes");
  if (alignment && !alignment->is(PickleKind::none)) {
    position += 1 + detail::load<std::uint8_t>(file, position, object.file(), "padding of an array");
  }
  const NpyArray described =
      detail::described_array(detail::pickled_dtype(state["dtype"]), detail::shape_of(state["shape"]),
                              concat_text(object.file(), ": array at byte ", object.at()));
  return {position, detail::checked_size(described.shape, described.item_size, object.file())};
}

MOTIONLANG_BODY NpyArray to_array(const PickleValue& value) { return detail::to_array(value, 0); }

MOTIONLANG_NAMESPACE_END
