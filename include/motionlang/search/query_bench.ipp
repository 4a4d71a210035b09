// SPDX-License-Identifier: MIT
// Bodies of query_bench.hpp.
#pragma once

#include <algorithm>  // any_of, search
#include <set>        // captions

#include <motionlang/core/formatted.hpp>
#include <motionlang/core/text_lines.hpp>
#include <motionlang/core/utf8.hpp>
#include <motionlang/file/file.hpp>
#include <motionlang/search/query_bench.hpp>
#include <motionlang/text/word_forms.hpp>
#include <motionlang/text/word_piece.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY std::vector<MotionQuery> read_queries(const FilePath& path) {
  std::vector<MotionQuery> out;
  detail::for_each_line(read_file(path), [&](std::string_view line, Index number) {
    if (line.empty() || line.front() == '#') return;
    const auto tab = line.find('\t');
    MotionQuery& query = out.emplace_back();
    query.text = line.substr(0, tab);
    const auto refuse = [&](const char* what) { raise<io_error>(403, path.string(), ":", number, ": ", what); };
    if (WordPiece::words(query.text).empty()) refuse("a query without words");
    if (tab == line.npos) return;
    for (std::string_view rest = line.substr(tab + 1);;) {
      const auto bar = rest.find('|');
      std::string phrase = join_text(WordPiece::words(rest.substr(0, bar)), " ");
      if (phrase.empty()) refuse("an empty phrase");
      query.phrases.push_back(std::move(phrase));
      if (bar == rest.npos) break;
      rest.remove_prefix(bar + 1);
    }
  });
  return out;
}

MOTIONLANG_BODY bool says(std::string_view text, std::string_view phrase) {
  const auto words = WordPiece::words(text), wanted = WordPiece::words(phrase);
  const auto is_form = [](const std::string& word, const std::string& of) {
    return known_form(word, [&](const std::string& form) { return form == of; }) == of;
  };
  return !wanted.empty() &&
         std::search(words.begin(), words.end(), wanted.begin(), wanted.end(), is_form) != words.end();
}

MOTIONLANG_BODY bool shows(const std::vector<std::string>& captions, const MotionQuery& query) {
  const auto right = std::count_if(captions.begin(), captions.end(), [&](const std::string& caption) {
    return std::any_of(query.phrases.begin(), query.phrases.end(),
                       [&](const std::string& phrase) { return says(caption, phrase); });
  });
  return right > 0 && 2 * right >= std::ssize(captions);
}

MOTIONLANG_BODY std::vector<QueryAnswer> answer_queries(const MotionIndex& index, const SearchEncoder& encoder,
                                                        const std::vector<MotionQuery>& queries) {
  MotionIndex captioned = index;
  captioned.remove_if([](const IndexedClip& c) { return c.captions.empty(); });
  if (captioned.count() == 0) raise<config_error>(101, "answer_queries: no clip of the index has captions");
  std::set<std::vector<std::string>> captions;
  for (const IndexedClip& c : captioned.clips()) {
    for (const std::string& caption : c.captions) captions.insert(WordPiece::words(caption));
  }
  const MotionSearch moves(captioned);
  std::vector<QueryAnswer> out;
  for (const MotionQuery& query : queries) {
    if (captions.contains(WordPiece::words(query.text)))
      raise<config_error>(102, "answer_queries: '", query.text, "' is a caption of a clip, word by word");
    const TextAnswer answer = answer_text(moves, encoder, query.text, {.top = 1});
    QueryAnswer& a = out.emplace_back();
    a.query = query, a.shown = answer.shown;
    a.found = clip_of(captioned, answer.hits.front()), a.score = answer.scores.front();
    a.right = query.phrases.empty() ? !a.shown : a.shown && shows(a.found.captions, query);
  }
  return out;
}

MOTIONLANG_BODY std::string describe_query_answers(const std::vector<QueryAnswer>& answers) {
  struct Count {
    int right = 0, all = 0;
  } shown, absent;
  std::string out;
  for (const QueryAnswer& a : answers) {
    Count& count = a.query.phrases.empty() ? absent : shown;
    count.right += a.right ? 1 : 0, ++count.all;
    const std::string answer = a.shown ? "\"" + a.found.captions.front() + "\"" : "no clip shows this";
    out += formatted("%-6s%.4f  %-44s %s\n", a.right ? "right" : "wrong", a.score, printable(a.query.text).c_str(),
                     printable(answer).c_str());
  }
  if (shown.all > 0) out += concat_text("the first result is right for ", shown.right, " of ", shown.all, " queries\n");
  if (absent.all > 0)
    out += concat_text("no clip shows this is the answer to ", absent.right, " of ", absent.all,
                       " queries that nothing shows\n");
  return out;
}

MOTIONLANG_NAMESPACE_END
