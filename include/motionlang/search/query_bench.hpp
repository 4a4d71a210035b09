// SPDX-License-Identifier: MIT
/// Measures a search by queries in everyday words: how often the first result is right by its captions.
///
///     const auto answers = answer_queries(index, tmr, read_queries("examples/training/queries.tsv"));
///     for (const QueryAnswer& a : answers) use(a.query.text, a.found, a.right);
#pragma once

#include <motionlang/file/file_path.hpp>
#include <motionlang/search/text_answer.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// A query, and phrases of which a right result's captions say one. Without phrases, no clip shows it.
struct MotionQuery {
  std::string text{};
  std::vector<std::string> phrases{};
  bool operator==(const MotionQuery&) const = default;
};

/// Lines "query, phrases separated by |", with a tab between both; lines that start with # are comments. Throws
/// io_error 401, and 403 with the line for a query without words or an empty phrase.
std::vector<MotionQuery> read_queries(const FilePath& path);

/// True if a text contains the words of a phrase one after the other. A word also counts in the forms of
/// text/word_forms.hpp: "sits down" says "sit".
bool says(std::string_view text, std::string_view phrase);
/// True if at least half of the captions say one of the phrases. One caption that was worded loosely is not enough.
bool shows(const std::vector<std::string>& captions, const MotionQuery& query);

struct QueryAnswer {
  MotionQuery query;
  IndexedClip found{};  // the first result
  double score = 0;     // its own
  bool shown = true;    // false: the answer is that no clip shows the query
  bool right = false;   // with phrases: shown, and its captions say one; without: not shown
};

/// Searches the clips that have captions.
/// Throws  config_error 101 if no clip has captions, 102 for a query that is itself a caption of a clip, and what
///         answer_text throws
std::vector<QueryAnswer> answer_queries(const MotionIndex& index, const SearchEncoder& encoder,
                                        const std::vector<MotionQuery>& queries);

/// A line for each answer, and how many are right: of queries that clips show, and of those that none shows.
std::string describe_query_answers(const std::vector<QueryAnswer>& answers);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/search/query_bench.ipp>
#endif
