#include "reconstruct/io/detail/byte_window.h"

#include "reconstruct/io/detail/file_bytes.h"

namespace umtet::detail {

const char* ByteWindow::take(std::size_t n) {
  if (n > bytes_left()) return nullptr;
  if (n > in_window()) {
    if (source_.rest == nullptr) return nullptr;
    window_ = source_.rest->from(at_, n);
    begin_ = at_;
    if (n > in_window()) return nullptr;  // it has become shorter
  }
  const char* const bytes = window_.data() + (at_ - begin_);
  at_ += n;
  return bytes;
}

void ByteWindow::refuse_surplus() {
  while (true) {
    detail::refuse_surplus(source_, window_.substr(at_ - begin_), at_);
    at_ = begin_ + window_.size();
    if (source_.rest == nullptr) return;
    window_ = source_.rest->from(at_, 1);
    begin_ = at_;
    if (window_.empty()) return;
  }
}

}  // namespace umtet::detail
