// SPDX-License-Identifier: MIT
/// An update of an index whose files several processes read and encode. The first one has the index and adds the clips
/// in the order of the files, so any number of processes writes the same index.
///
///     if (all.rank() > 0) return encode_for_first(all, tmr, read);
///     SharedFileEncoder encoder(all, tmr, store.model(), read);
///     update.run(progress, &encoder);
#pragma once

#include <motionlang/search/index_folder.hpp>
#include <motionlang/train/communicator.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// The encoder in the first process. The others leave encode_for_first when it ends.
class SharedFileEncoder : public FileEncoder {
 public:
  /// The encoder must outlive the object, and so must what `all` refers to.
  SharedFileEncoder(const AnyCommunicator& all, const SearchEncoder& encoder, IndexModel model,
                    MotionReadOptions read = {});
  ~SharedFileEncoder() override;
  SharedFileEncoder(const SharedFileEncoder&) = delete;
  SharedFileEncoder& operator=(const SharedFileEncoder&) = delete;

  Index at_once() const override;
  std::vector<std::vector<ClipToIndex>> encode(std::span<const FileToIndex> files) override;

 private:
  AnyCommunicator all_;
  const SearchEncoder& encoder_;
  MotionReadOptions read_;
  IndexModel model_;
};

/// The work of the other processes. Their encoders have the same model, and they read with the same options.
void encode_for_first(const AnyCommunicator& all, const SearchEncoder& encoder, const MotionReadOptions& read = {});

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/train/shared_index.ipp>
#endif
