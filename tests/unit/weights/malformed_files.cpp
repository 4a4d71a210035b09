// The malformed files of the golden cases: each is refused for what is wrong with it, not for something that it only
// looks like.
#include <map>

#include <motionlang/weights/weight_file.hpp>

#include "../../support/check_error.hpp"
#include "../../support/tests_folder.hpp"

namespace ml = motionlang;

namespace {

const std::filesystem::path folder = std::filesystem::path(tests_folder()) / "golden/cases/containers/malformed";

struct Reason {
  int id;
  const char* text;
};
/// By the name of the file without ".bad".
const std::map<std::string, Reason> reasons{
    {"ckpt_eval.ckpt", {404, "names __builtin__.eval: the file tries to execute code at byte 205 (GLOBAL)"}},
    {"legacy_huge_count.pt", {405, "storage '447819920' of 1152921504606846976 elements at byte 339 of 363"}},
    {"legacy_os_system.pt", {404, "names posix.system: the file tries to execute code at byte 315 (GLOBAL)"}},
    {"legacy_truncated_pickle.pt", {402, "ends inside integer at byte 119 (BININT1)"}},
    {"legacy_truncated_storage.pt", {402, "a storage needs 24 bytes at byte 339, the file has 358"}},
    {"legacy_wrong_magic.pt",
     {404, "not the magic number of PyTorch's older files, although pickles follow it, at byte 2 (LONG1)"}},
    {"npy_header_too_long.npy", {402, "npy header needs 60000 bytes at byte 10, the file has 176"}},
    {"npy_magic.npy", {404, "not a file of weights: neither safetensors, PyTorch, NumPy, nor a pickle"}},
    {"npy_negative_shape.npy", {403, "npy header: a size that is not negative expected at byte 61"}},
    {"npy_no_dict.npy", {403, "npy header: '{' expected at byte 10"}},
    {"npy_object.npy", {404, "npy at byte 10: element type '|O'"}},
    {"npy_shape_overflow.npy", {405, "npy at byte 10: the product of the shape is too large"}},
    {"npy_trailing.npy", {403, "npy at byte 10: 2 bytes after the array data"}},
    {"npy_truncated.npy", {402, "npy at byte 10: array data of 41 bytes, 48 needed"}},
    {"npy_version.npy", {404, ".npy version 9 at byte 6"}},
    {"npz_bomb.npz", {405, "entry at byte 3039: member 'z.npy' of 2147483648 bytes cannot come from 3004"}},
    {"npz_corrupt_deflate.npz", {403, "deflated data: over-subscribed code at byte 70"}},
    {"npz_encrypted.npz", {404, "entry at byte 5864: member 'poses.npy' is encrypted"}},
    {"npz_path.npz", {403, "entry at byte 218: member '../poses.npy' leads out of the archive"}},
    {"npz_truncated.npz", {403, "no end record of a zip archive from byte 0 on: not a zip, or cut off"}},
    {"npz_wrong_size.npz", {405, "deflated data gives more than 50 bytes"}},
    {"pickle_empty_stack.pkl", {403, "nothing on the stack at byte 2 (STOP)"}},
    {"pickle_frame.pkl", {402, "a frame of 18446744073709551615 bytes where 2 are left at byte 2 (FRAME)"}},
    {"pickle_long_string.pkl", {402, "text of 2147483647 bytes where 2 are left at byte 2 (BINUNICODE)"}},
    {"pickle_memo.pkl", {403, "memo 7 was never written at byte 2 (BINGET)"}},
    {"pickle_os_system.pkl", {404, "names posix.system: the file tries to execute code at byte 249 (GLOBAL)"}},
    {"pickle_text_system.pkl", {404, "names posix.system: the file tries to execute code at byte 0 (GLOBAL)"}},
    {"pt_bad_directory.pt", {402, "ends inside ZIP64 end record at byte 4611686018427387904 (738 bytes)"}},
    {"pt_duplicate_entry.pt", {403, "two members are called 'tiny/data/0', one of them at byte 359"}},
    {"pt_missing_storage.pt", {403, "storage '0' is not in the file at byte 109 (BINPERSID)"}},
    {"pt_negative_stride.pt", {405, "a tensor with a negative size or stride at byte 126 (TUPLE2)"}},
    {"pt_no_pickle.pt", {403, "a zip archive without data.pkl (PyTorch) and .npy (NumPy)"}},
    {"pt_offset_out_of_range.pt",
     {405, "a tensor of shape (2, 3) reaches behind the end of its storage at byte 161 (REDUCE)"}},
    {"pt_os_system.pt", {404, "names posix.system: the file tries to execute code at byte 169 (GLOBAL)"}},
    {"pt_pickle_cut.pt", {402, "a line without end at byte 64 (GLOBAL)"}},
    {"pt_short_storage.pt", {405, "storage '0' has 20 bytes, not 6 times 4 at byte 109 (BINPERSID)"}},
    {"pt_size_out_of_range.pt",
     {405, "a tensor of shape (64, 3) reaches behind the end of its storage at byte 161 (REDUCE)"}},
    {"pt_stride_out_of_range.pt",
     {405, "a tensor of shape (2, 3) reaches behind the end of its storage at byte 161 (REDUCE)"}},
    {"pt_truncated.pt", {403, "no end record of a zip archive from byte 0 on: not a zip, or cut off"}},
    {"pt_wrong_crc.pt", {403, "data.pkl at byte 64: checksum 2415502470, the directory says 2415502457"}},
    {"st_bad_dtype.safetensors", {404, "byte 22: unknown dtype 'Q32'"}},
    {"st_duplicate.safetensors", {403, "byte 62: the name 'a' is duplicated in one object"}},
    {"st_float_offset.safetensors", {403, "byte 59: a fraction where an integer is due"}},
    {"st_header_huge.safetensors", {405, "a header of 18446744073709551615 bytes; at most 100000000"}},
    {"st_header_too_long.safetensors", {402, "the header needs 1000000 bytes at byte 8, the file has 70"}},
    {"st_hole.safetensors", {403, "byte 66: data_offsets [12, 20] leave a hole after byte 8"}},
    {"st_negative.safetensors", {403, "byte 56: expected an integer of at least 0"}},
    {"st_not_json.safetensors", {403, "byte 61: expected '}', but the header ends"}},
    {"st_not_object.safetensors", {403, "byte 8: a header has to begin with '{'"}},
    {"st_not_utf8.safetensors", {403, "byte 10: not UTF-8"}},
    {"st_overlap.safetensors", {403, "byte 66: data_offsets [4, 12] overlap the range before, which ends at 8"}},
    {"st_reversed.safetensors", {405, "byte 13: tensor 'a': F32 (2) does not fill data_offsets [8, 0]"}},
    {"st_same_range.safetensors", {403, "byte 13: data_offsets [0, 8] overlap the range before, which ends at 8"}},
    {"st_shape_overflow.safetensors", {405, "byte 39: an integer above 2^63 - 1"}},
    {"st_short_file.safetensors", {402, "5 bytes are not a file of weights of any kind"}},
    {"st_size_mismatch.safetensors", {405, "byte 13: tensor 'a': F32 (3) does not fill data_offsets [0, 8]"}},
    {"st_trailing_bytes.safetensors", {403, "byte 8: 1 byte of data belongs to no tensor"}},
    {"st_truncated_data.safetensors", {402, "byte 66: tensor 'b' ends at 16, the data have 13 bytes"}},
    {"st_truncated_header.safetensors", {402, "the header needs 108 bytes at byte 8, the file has 20"}},
};

}  // namespace

TEST_CASE("malformed files are refused with the right reason") {
  std::size_t count = 0;
  for (const auto& file : std::filesystem::directory_iterator(folder)) {
    const auto reason = reasons.find(file.path().stem().string());
    REQUIRE_MESSAGE(reason != reasons.end(), file.path());
    CAPTURE(reason->first);
    CHECK_ERROR(ml::open_weights(file.path()), reason->second.text);
    CHECK_ERROR(ml::open_weights(file.path()), ml::concat_text("[motionlang.io.", reason->second.id, "]").c_str());
    ++count;
  }
  CHECK(count == reasons.size());
}
