#include "distributed/io/shared_arrays.h"

#include <utility>

namespace umtet {

SharedArrays::SharedArrays(SharedFile& file, std::vector<const VtuShape::Array*> arrays)
    : file_(file), arrays_(std::move(arrays)), pieces_(arrays_.size()) {}

void SharedArrays::write() {
  for (std::size_t a = 0; a < pieces_.size(); ++a) {
    if (!pieces_[a].bytes.empty()) file_.write(arrays_[a]->begin + pieces_[a].first, pieces_[a].bytes);
  }
}

}  // namespace umtet
