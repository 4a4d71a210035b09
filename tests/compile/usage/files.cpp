// Names that the usage examples of file/ and formats/ use without declaring them.
#include "usage.hpp"

#include <motionlang/file/json.hpp>
#include <motionlang/file/json_members.hpp>
#include <motionlang/file/options_file.hpp>
#include <motionlang/file/output_folder.hpp>
#include <motionlang/file/pickle.hpp>
#include <motionlang/file/pickle_arrays.hpp>
#include <motionlang/file/safetensors.hpp>
#include <motionlang/file/torch_archive.hpp>
#include <motionlang/file/torch_file.hpp>
#include <motionlang/formats/amass_body.hpp>
#include <motionlang/formats/amass_sequence.hpp>
#include <motionlang/formats/body_file.hpp>
#include <motionlang/formats/body_glb.hpp>
#include <motionlang/formats/figure_body.hpp>
#include <motionlang/formats/mdm_results.hpp>
#include <motionlang/formats/merged_body.hpp>
#include <motionlang/formats/motion_npy.hpp>
#include <motionlang/weights/module_file.hpp>

void torch_archive(const TensorStore& store) {
#include "file/torch_archive.1.inc"
}
void json() {
#include "file/json.1.inc"
}
void members() {
#include "file/json_members.1.inc"
}
void options_of() {
#include "file/options_file.1.inc"
}
void output_folder() {
#include "file/output_folder.1.inc"
}
void pickle() {
#include "file/pickle.1.inc"
}
void arrays() {
#include "file/pickle_arrays.1.inc"
}
void safetensors() {
#include "file/safetensors.1.inc"
}
void torch() {
#include "file/torch_file.1.inc"
}
void amass(const Body<B>& body) {
#include "formats/amass_body.1.inc"
}
void body_file(const Tensor<B, 2>& betas, const Tensor<B, 3>& rotations, const Tensor<B, 2>& translation) {
#include "formats/body_file.1.inc"
}
void hands(Body<B>& body) {
#include "formats/body_file.2.inc"
}
void body_glb(const Body<B>& body, const Motion& motion) {
#include "formats/body_glb.1.inc"
}
void figure(const Motion& motion) {
#include "formats/figure_body.1.inc"
}
void mdm_results() {
#include "formats/mdm_results.1.inc"
}
void merge() {
#include "formats/merged_body.1.inc"
}
void npy() {
#include "formats/motion_npy.1.inc"
}
