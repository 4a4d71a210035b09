// motionlang embed: the vectors of a text encoder for texts, in the layout that TMR and STMC read.
#include <cstdio>
#include <map>

#include <motionlang/backend/eigen.hpp>
#include <motionlang/weights/embed_texts.hpp>
#include <motionlang/weights/text_encoder_folder.hpp>

#include "../commands.hpp"
#include "../option_checks.hpp"
#include "../progress_bar.hpp"

namespace program {

namespace {

namespace ml = motionlang;
using B = ml::EigenBackend<float>;

struct EmbedOptions {
  std::string texts, encoder, out, name, pooling = "none";
  bool normalize = false, empty = true, truncate = false;
  ml::Index batch = 32;
};

/// The last name of a path, with or without a slash after it.
std::string last_name(const std::string& path) {
  const auto whole = std::filesystem::absolute(path).lexically_normal();
  return (whole.has_filename() ? whole : whole.parent_path()).filename().string();
}

void run(EmbedOptions o) {
  const std::map<std::string, ml::Pooling> poolings{{"none", ml::Pooling::none},
                                                    {"mean", ml::Pooling::mean},
                                                    {"first", ml::Pooling::first},
                                                    {"end", ml::Pooling::end}};
  ml::TextEncoderOptions options{.text = {.pooling = poolings.at(o.pooling), .normalize = o.normalize}};
  if (o.truncate) options.limits.truncate = true;
  options.limits.cleaning = ml::ClipCleaning::original;  // as in STMC's own caches
  const auto encoder = ml::load_text_encoder<B>(o.encoder, options);
  if (o.name.empty()) o.name = last_name(o.encoder);
  std::vector<std::string> texts = ml::texts_to_embed(o.texts);
  if (o.empty) texts.insert(texts.begin(), "");  // the unconditional text of diffusion models
  const ml::EmbeddingCache cache = [&] {
    ProgressBar bar("embedding");
    return ml::embed_texts<B>(encoder, texts, o.batch, bar);
  }();
  const bool sentences = o.pooling == "mean" || o.pooling == "first";  // TMR's caches have no slices
  cache.write(o.out, o.name, !sentences);
  std::printf("%s/%s: %s, rows of %s\n", o.out.c_str(), o.name.c_str(), ml::counted(cache.count(), "text").c_str(),
              ml::counted(cache.width(), "number").c_str());
}

}  // namespace

void add_embed(CLI::App& app) {
  const auto o = std::make_shared<EmbedOptions>();
  CLI::App* c = app.add_subcommand(
      "embed", "Writes text vectors to NAME.npy, NAME_slice.npy and NAME_index.json, in the layout of TMR and STMC");
  file_option(*c, "texts", o->texts, "File with one text per line, or an annotations.json")->required();
  path_option(
      *c, "--encoder", o->encoder,
      "Folder of Hugging Face (distilbert, bert, mpnet, clip), or OpenAI's ViT-B-32.pt with its vocabulary beside it")
      ->required();
  c->add_option("-o,--out", o->out, "Folder for the files")->required();
  c->add_option(
      "--name", o->name,
      "Name of the encoder in the file names; 'ViT-B/32' makes a subfolder. The default is the name of its folder");
  checked_option(*c, "--pooling", o->pooling, CLI::IsMember({"none", "mean", "first", "end"}),
                 "Rows to write. none: one per token (TMR's token_embeddings); mean, first: one per text; end: CLIP's "
                 "text vector (STMC)");
  c->add_flag("--normalize", o->normalize, "Scale text vectors to length 1 (TMR's sent_embeddings)");
  c->add_flag("--empty,!--no-empty", o->empty, "Also embed the empty text, which is the unconditional one")
      ->capture_default_str();
  c->add_flag("--truncate", o->truncate,
              "Cut texts that are longer than the encoder takes (512 ids); otherwise they are an error. CLIP always "
              "cuts at 77 ids");
  checked_option(*c, "--batch", o->batch, in_range(1, 4096), "Number of texts encoded together");
  c->callback([o] { run(*o); });
}

}  // namespace program
