// A comment of more than 120 columns, which clang-format leaves as it is because the house does not reflow any comments at all.
