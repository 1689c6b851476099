#include "framework/foundation/support/error.h"

namespace lockstep {

// Out of line, so that each error type has one type record in the process and a plugin's throw meets the host's catch.
Error::~Error() = default;
ModelError::~ModelError() = default;
AssemblyError::~AssemblyError() = default;
SolveError::~SolveError() = default;
StepError::~StepError() = default;
NonFiniteError::~NonFiniteError() = default;
PluginError::~PluginError() = default;
SceneError::~SceneError() = default;
FileError::~FileError() = default;

}  // namespace lockstep
