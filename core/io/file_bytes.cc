#include "core/io/file_bytes.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <climits>
#include <cstring>

#include "absl/strings/str_cat.h"
#include "core/base/status_macros.h"
#include "core/io/links.h"

namespace meshfront {
namespace {

constexpr uint64_t kFirstBlock = 64 << 10;
constexpr size_t kMostPerCall = 1 << 30;

class Descriptor {
 public:
  explicit Descriptor(int fd) : fd_(fd) {}
  ~Descriptor() { Close(); }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  int get() const { return fd_; }
  bool Close() {
    const int fd = fd_;
    fd_ = -1;
    return fd < 0 || ::close(fd) == 0;
  }

 private:
  int fd_;
};

absl::Status SystemError(int error, const std::string& path, absl::string_view what) {
  return absl::ErrnoToStatus(error, absl::StrCat(path, " ", what));
}

class FileSink : public ByteSink {
 public:
  FileSink(int fd, std::string path) : fd_(fd), path_(std::move(path)) {}
  absl::Status Append(std::string_view bytes) override {
    while (!bytes.empty()) {
      const ssize_t count = ::write(fd_, bytes.data(), std::min(bytes.size(), kMostPerCall));
      if (count < 0 && errno == EINTR) continue;
      if (count < 0) return SystemError(errno, path_, "can't be written");
      bytes.remove_prefix(count);
    }
    return absl::OkStatus();
  }

 private:
  int fd_;
  std::string path_;
};

std::string FolderOf(const std::string& path) {
  const size_t slash = path.rfind('/');
  return slash == std::string::npos ? "." : slash == 0 ? "/" : path.substr(0, slash);
}

// A name nobody has, in the folder of `path`, opened for writing with the rights a new file gets. Sets `name`.
int CreateBeside(const std::string& path, std::string& name) {
  static std::atomic<uint64_t> counter{0};
  const std::string folder = FolderOf(path);
  for (int attempt = 0; attempt < 1000; ++attempt) {
    name = absl::StrCat(folder, "/.meshfront-", ::getpid(), "-", counter++, ".tmp");
    const int fd = ::open(name.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (fd >= 0 || errno != EEXIST) return fd;
  }
  return -1;
}

// Fills the temporary file and makes it durable; the caller renames or removes it.
absl::Status FillTemporary(Descriptor& file, const std::string& path,
                           const std::function<absl::Status(ByteSink&)>& write) {
  FileSink sink(file.get(), path);
  MESHFRONT_RETURN_IF_ERROR(write(sink));
  struct stat old = {};
  if (::stat(path.c_str(), &old) == 0 && ::fchmod(file.get(), old.st_mode & 07777) != 0) {
    return SystemError(errno, path, "can't be given its old rights");
  }
  if (::fsync(file.get()) != 0 || !file.Close()) return SystemError(errno, path, "can't be written");
  return absl::OkStatus();
}

}  // namespace

bool ByteBuffer::Resize(uint64_t size) {
  if (size > PTRDIFF_MAX) return false;
  void* moved = std::realloc(bytes_.get(), std::max<uint64_t>(size, 1));
  if (moved == nullptr) return false;
  bytes_.release();
  bytes_.reset(static_cast<uint8_t*>(moved));
  size_ = size;
  return true;
}

absl::StatusOr<ByteBuffer> ReadWholeFile(const std::string& path, uint64_t limit) {
  Descriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
  struct stat facts = {};
  if (file.get() < 0 || ::fstat(file.get(), &facts) != 0) {
    return absl::NotFoundError(absl::StrCat(path, " can't be opened: ", std::strerror(errno)));
  }
  if (S_ISDIR(facts.st_mode)) return absl::NotFoundError(absl::StrCat(path, " is a folder, not a file"));
  auto too_long = [&] {
    return absl::InvalidArgumentError(absl::StrCat(path, ": is longer than ", limit, " bytes, which is the limit"));
  };
  if (facts.st_size > 0 && static_cast<uint64_t>(facts.st_size) > limit) return too_long();
  ByteBuffer bytes;
  uint64_t used = 0;
  // One byte more than the file is said to have, so that its end is seen without growing.
  uint64_t room = facts.st_size > 0 ? facts.st_size + 1 : kFirstBlock;
  for (;;) {
    if (used == bytes.size()) {
      if (!bytes.Resize(room))
        return absl::ResourceExhaustedError(absl::StrCat(path, ": no memory for ", room, " bytes"));
      room = 2 * bytes.size();
    }
    const ssize_t count =
        ::read(file.get(), bytes.data() + used, std::min<uint64_t>(bytes.size() - used, kMostPerCall));
    if (count < 0 && errno == EINTR) continue;
    if (count < 0)
      return absl::UnavailableError(absl::ErrnoToStatus(errno, absl::StrCat(path, ": reading broke off")).message());
    if (count == 0) break;
    used += count;
    if (used > limit) return too_long();
  }
  bytes.Resize(used);
  return bytes;
}

absl::Status ReplaceFile(const std::string& path, const std::function<absl::Status(ByteSink&)>& write) {
  const std::string target = FileBehindLinks(path);
  struct stat facts = {};
  const bool exists = ::stat(target.c_str(), &facts) == 0;
  if (exists && S_ISDIR(facts.st_mode)) return absl::FailedPreconditionError(absl::StrCat(path, " is a folder"));
  if (exists && !S_ISREG(facts.st_mode)) {  // a pipe or a device can't be replaced
    Descriptor device(::open(target.c_str(), O_WRONLY | O_CLOEXEC));
    if (device.get() < 0) return SystemError(errno, path, "can't be opened for writing");
    FileSink sink(device.get(), path);
    return write(sink);
  }
  std::string temporary;
  Descriptor file(CreateBeside(target, temporary));
  if (file.get() < 0) return SystemError(errno, path, "can't be created");
  absl::Status status = FillTemporary(file, target, write);
  if (status.ok() && ::rename(temporary.c_str(), target.c_str()) != 0)
    status = SystemError(errno, path, "can't be replaced");
  if (!status.ok()) {
    ::unlink(temporary.c_str());
    return status;
  }
  Descriptor folder(::open(FolderOf(target).c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (folder.get() >= 0) ::fsync(folder.get());  // some file systems refuse to sync folders; the file itself is safe
  return absl::OkStatus();
}

}  // namespace meshfront
