// Tokenizers, one thread, in MB/s of text: the median of the runs over all captions.
//
//     bench_tokenizers DATA      DATA/tokenizers/..., DATA/text/kitml-annotations.json
#include <motionlang/datasets/annotations.hpp>
#include <motionlang/weights/tokenizer_files.hpp>

#include "bench.hpp"

namespace ml = motionlang;

template <class T>
void report(const char* work, const T& tokenizer, const std::vector<std::string>& texts) {
  std::size_t bytes = 0;
  for (const std::string& t : texts) bytes += t.size();
  ml::Index ids = 0;
  const auto all = [&] { ids = std::ssize(ml::tokenize(tokenizer, texts).ids); };
  all();
  const auto times = bench::times_of(all, 3, 5, 100);
  const auto speed = [&](double seconds) { return static_cast<double>(bytes) * 1e-6 / seconds; };
  std::printf("%s,%zu texts,%zu bytes,%td ids,median %.1f MB/s,best %.1f MB/s\n", work, texts.size(), bytes, ids,
              speed(times[times.size() / 2]), speed(times.front()));
  std::fflush(stdout);
}

int main(int argc, char** argv) {
  if (argc != 2) return std::fprintf(stderr, "usage: bench_tokenizers DATA\n"), 2;
  const std::string data = argv[1], merges = data + "/tokenizers/bpe_simple_vocab_16e6.txt.gz";
  std::vector<std::string> captions;
  const auto file = ml::AnnotationFile::open(data + "/text/kitml-annotations.json");
  for (const std::string& id : file.ids()) {
    for (const ml::Annotation& a : file.load(id).annotations) captions.push_back(a.text);
  }
  std::vector<std::string> accented;  // no longer ASCII: the slow way through Unicode
  for (const std::string& c : captions) accented.push_back(c + " caf\u00e9");
  const auto bert = ml::read_bert_tokenizer(data + "/tokenizers/bert_vocab.txt");
  const auto clip = ml::read_clip_tokenizer(merges);
  report("WordPiece", bert, captions);
  report("BPE", clip, captions);
  report("BPE without memory of words", ml::read_clip_tokenizer(merges, {.cached_words = 0}), captions);
  report("WordPiece of accented captions", bert, accented);
  report("BPE of accented captions", clip, accented);
}
