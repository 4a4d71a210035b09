// SPDX-License-Identifier: MIT
// Bodies of shared_index.hpp.
#pragma once

#include <motionlang/core/parallel.hpp>
#include <motionlang/train/messages.hpp>
#include <motionlang/train/shared_index.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// Files with the parts of their lines that reading needs.
inline void put_files(MessageWriter& out, std::span<const FileToIndex> files) {
  out.value(std::uint64_t{files.size()});
  for (const FileToIndex& f : files) {
    out.text(f.path.string());
    out.value(f.modified), out.value(f.bytes);
    out.value(std::uint8_t{f.lines.has_value()});
    out.value(std::uint64_t{f.lines ? f.lines->size() : 0});
    if (!f.lines) continue;
    for (const ClipLine& line : *f.lines) {
      out.text(line.place), out.text(line.clip), out.text(line.animation);
      out.value(line.start), out.value(line.end);
      out.value(std::uint64_t{line.texts.size()});
      for (const std::string& text : line.texts) out.text(text);
    }
  }
}
inline std::vector<FileToIndex> take_files(MessageReader& in) {
  std::vector<FileToIndex> out;
  for (auto files = in.value<std::uint64_t>(); files > 0; --files) {
    FileToIndex& f = out.emplace_back();
    f.path = in.text();
    f.modified = in.value<std::int64_t>(), f.bytes = in.value<std::int64_t>();
    if (in.value<std::uint8_t>() != 0) f.lines.emplace();
    for (auto lines = in.value<std::uint64_t>(); lines > 0; --lines) {
      ClipLine& line = f.lines->emplace_back();
      line.place = in.text(), line.clip = in.text(), line.animation = in.text();
      line.start = in.value<double>(), line.end = in.value<double>();
      for (auto texts = in.value<std::uint64_t>(); texts > 0; --texts) line.texts.push_back(in.text());
    }
  }
  return out;
}

inline void put_clips(MessageWriter& out, std::span<const std::vector<ClipToIndex>> files) {
  for (const auto& clips : files) {
    out.value(std::uint64_t{clips.size()});
    for (const ClipToIndex& c : clips) {
      const IndexedClip& clip = c.clip.clip;
      for (const std::string* text : {&c.problem, &clip.path, &clip.name, &clip.content, &clip.lines}) out.text(*text);
      out.value(clip.modified), out.value(clip.bytes);
      out.value(clip.start), out.value(clip.end), out.value(clip.fps), out.value(std::int64_t{clip.frames});
      out.value(std::uint64_t{clip.captions.size()});
      for (const std::string& text : clip.captions) out.text(text);
      out.list(std::span<const float>(c.clip.vector)), out.list(std::span<const float>(c.clip.moment_vectors));
      out.value(std::uint64_t{c.clip.moments.size()});
      for (const FrameSlice& m : c.clip.moments) out.value(std::int64_t{m.first}), out.value(std::int64_t{m.length});
    }
  }
}
inline std::vector<std::vector<ClipToIndex>> take_clips(MessageReader& in, std::size_t files) {
  std::vector<std::vector<ClipToIndex>> out(files);
  for (auto& clips : out) {
    for (auto left = in.value<std::uint64_t>(); left > 0; --left) {
      ClipToIndex& c = clips.emplace_back();
      IndexedClip& clip = c.clip.clip;
      for (std::string* text : {&c.problem, &clip.path, &clip.name, &clip.content, &clip.lines}) *text = in.text();
      clip.modified = in.value<std::int64_t>(), clip.bytes = in.value<std::int64_t>();
      clip.start = in.value<double>(), clip.end = in.value<double>(), clip.fps = in.value<double>();
      clip.frames = static_cast<Index>(in.value<std::int64_t>());
      for (auto texts = in.value<std::uint64_t>(); texts > 0; --texts) clip.captions.push_back(in.text());
      c.clip.vector = in.list<float>(), c.clip.moment_vectors = in.list<float>();
      for (auto moments = in.value<std::uint64_t>(); moments > 0; --moments) {
        const auto first = in.value<std::int64_t>(), length = in.value<std::int64_t>();
        c.clip.moments.push_back({static_cast<Index>(first), static_cast<Index>(length)});
      }
    }
  }
  return out;
}

/// The windows of a model, which decide the moments.
inline void put_model(MessageWriter& out, const IndexModel& m) {
  out.text(m.id), out.value(std::int64_t{m.width}), out.value(m.fps), out.value(std::int64_t{m.stride});
  out.value(std::uint64_t{m.windows.size()});
  for (const Index w : m.windows) out.value(std::int64_t{w});
}
inline IndexModel take_model(MessageReader& in) {
  IndexModel m{.id = in.text(), .path = {}};
  m.width = static_cast<Index>(in.value<std::int64_t>()), m.fps = in.value<double>();
  m.stride = static_cast<Index>(in.value<std::int64_t>());
  for (auto left = in.value<std::uint64_t>(); left > 0; --left)
    m.windows.push_back(static_cast<Index>(in.value<std::int64_t>()));
  return m;
}

}  // namespace detail

MOTIONLANG_BODY SharedFileEncoder::SharedFileEncoder(const AnyCommunicator& all, const SearchEncoder& encoder,
                                                     IndexModel model, MotionReadOptions read)
    : all_(all), encoder_(encoder), read_(std::move(read)), model_(std::move(model)) {
  MessageWriter out;
  detail::put_model(out, model_);
  for (Index r = 1; r < all_.size(); ++r) send_message(all_, out.bytes(), r);
}

MOTIONLANG_BODY SharedFileEncoder::~SharedFileEncoder() {
  for (Index r = 1; r < all_.size(); ++r) send_message(all_, "", r);
}

MOTIONLANG_BODY Index SharedFileEncoder::at_once() const { return 8 * thread_count() * all_.size(); }

MOTIONLANG_BODY std::vector<std::vector<ClipToIndex>> SharedFileEncoder::encode(std::span<const FileToIndex> files) {
  const auto first_of = [&](Index rank) { return static_cast<std::size_t>(std::ssize(files) * rank / all_.size()); };
  const auto part = [&](Index rank) { return files.subspan(first_of(rank), first_of(rank + 1) - first_of(rank)); };
  for (Index r = 1; r < all_.size(); ++r) {
    MessageWriter out;
    detail::put_files(out, part(r));
    send_message(all_, out.bytes(), r);
  }
  auto clips = encode_files(part(0), encoder_, model_, read_);
  for (Index r = 1; r < all_.size(); ++r) {
    const std::string message = receive_message(all_, r);
    MessageReader in(message);
    for (auto& of_file : detail::take_clips(in, part(r).size())) clips.push_back(std::move(of_file));
  }
  return clips;
}

MOTIONLANG_BODY void encode_for_first(const AnyCommunicator& all, const SearchEncoder& encoder,
                                      const MotionReadOptions& read) {
  const std::string about = receive_message(all, 0);
  MessageReader model_in(about);
  const IndexModel model = detail::take_model(model_in);
  if (model.id != encoder.model().id)
    raise<config_error>(102, "rank ", all.rank(), " has the model ", encoder.model().id, ", the first process has ",
                        model.id);
  for (std::string message = receive_message(all, 0); !message.empty(); message = receive_message(all, 0)) {
    MessageReader in(message);
    const auto files = detail::take_files(in);
    MessageWriter out;
    detail::put_clips(out, encode_files(files, encoder, model, read));
    send_message(all, out.bytes(), 0);
  }
}

MOTIONLANG_NAMESPACE_END
