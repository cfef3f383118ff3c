#pragma once

#include <string_view>

namespace umtet {

// The files of report/ and three.js, embedded in the program by report/embed.cmake.
std::string_view report_page_html();
std::string_view report_page_css();
std::string_view report_scenes_js();
std::string_view report_view_js();
std::string_view report_viewer_js();
std::string_view report_three_js();

}  // namespace umtet
