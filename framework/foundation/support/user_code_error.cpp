#include "framework/foundation/support/user_code_error.h"

namespace lockstep {

UserCodeError::~UserCodeError() = default;  // here, so that its type record stands in the library alone

}  // namespace lockstep
