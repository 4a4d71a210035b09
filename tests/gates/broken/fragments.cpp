// What a comment is about.

/// Whether it is a sentence.
bool is_sentence();  // Of the comment above.
