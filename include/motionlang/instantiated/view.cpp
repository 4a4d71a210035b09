// SPDX-License-Identifier: MIT
// Bodies of the headers in view/, compiled once for motionlang::instantiated.
#include <motionlang/view/bar_chart.ipp>
#include <motionlang/view/contact_sheet.ipp>
#include <motionlang/view/detail/markup.ipp>
#include <motionlang/view/detail/stroke_font.ipp>
#include <motionlang/view/film_strip.ipp>
#include <motionlang/view/inspection_page.ipp>
#include <motionlang/view/loss_curves.ipp>
#include <motionlang/view/retrieval_page.ipp>
#include <motionlang/view/similarity_picture.ipp>
#include <motionlang/view/study_chart.ipp>
#include <motionlang/view/text_colours.ipp>
#include <motionlang/view/timeline_picture.ipp>
#include <motionlang/view/track.ipp>
