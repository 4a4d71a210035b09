# sources: the files of C and C++ that git knows, but for what is generated. Sourced by the gates.
sources() {
  git ls-files -- '*.hpp' '*.ipp' '*.inc' '*.cpp' '*.h' '*.c' ':!single_include'
}
