#include "core/base/exceptions.h"

#include <new>
#include <stdexcept>
#include <string>
#include <system_error>

namespace meshfront {
namespace {

constexpr char kOutOfMemory[] = "there is not enough memory for this job";

}  // namespace

absl::Status StatusOf(const std::exception_ptr& exception) {
  try {
    std::rethrow_exception(exception);
  } catch (const std::bad_alloc&) {
    return absl::ResourceExhaustedError(kOutOfMemory);
  } catch (const std::length_error&) {  // an array longer than any can be
    return absl::ResourceExhaustedError(kOutOfMemory);
  } catch (const std::system_error& e) {
    // A thread without room for its stack.
    if (e.code() == std::errc::resource_unavailable_try_again || e.code() == std::errc::not_enough_memory) {
      return absl::ResourceExhaustedError(kOutOfMemory);
    }
    return absl::InternalError(std::string("exception: ") + e.what());
  } catch (const std::exception& e) {
    return absl::InternalError(std::string("exception: ") + e.what());
  } catch (...) {
    return absl::InternalError("exception of unknown type");
  }
}

bool IsOutOfMemory(const absl::Status& status) {
  return absl::IsResourceExhausted(status) && status.message() == kOutOfMemory;
}

}  // namespace meshfront
