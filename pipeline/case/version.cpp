#include "pipeline/case/version.h"

namespace umtet {

const char* const kVersion = UMTET_VERSION;

}  // namespace umtet
