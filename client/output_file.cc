#include "client/output_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <map>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "core/base/status_macros.h"
#include "core/io/links.h"

namespace meshfront {
namespace {

absl::Status SystemError(absl::string_view name, absl::string_view what, int error) {
  return absl::InternalError(absl::StrCat(name, " ", what, ": ", strerror(error)));
}

// mkstemp makes files that only their owner reads; an output gets the permissions of any other new file.
void ApplyUsualPermissions(int descriptor) {
  const mode_t mask = umask(0);
  umask(mask);
  fchmod(descriptor, 0666 & ~mask);
}

absl::StatusOr<int> CreateTemporary(const std::string& prefix, const std::string& shown_name, std::string* path) {
  *path = absl::StrCat(prefix, ".XXXXXX");
  const int descriptor = mkostemp(path->data(), O_CLOEXEC);
  if (descriptor < 0) return SystemError(shown_name, "can't be written", errno);
  return descriptor;
}

}  // namespace

BufferedFile::BufferedFile(int descriptor, std::string name) : descriptor_(descriptor), name_(std::move(name)) {
  buffer_.reserve(kBufferBytes);
}

BufferedFile::~BufferedFile() {
  if (descriptor_ > STDERR_FILENO) close(descriptor_);
}

absl::Status BufferedFile::Append(absl::string_view bytes) {
  size_ += bytes.size();
  if (buffer_.size() + bytes.size() > kBufferBytes) MESHFRONT_RETURN_IF_ERROR(Flush());
  if (bytes.size() >= kBufferBytes) return WriteThrough(bytes.data(), bytes.size());
  buffer_.append(bytes.data(), bytes.size());
  return absl::OkStatus();
}

absl::Status BufferedFile::Flush() {
  const absl::Status written = WriteThrough(buffer_.data(), buffer_.size());
  buffer_.clear();
  return written;
}

absl::Status BufferedFile::WriteThrough(const char* bytes, size_t count) {
  if (descriptor_ < 0) return absl::InternalError(absl::StrCat(name_, " can't be written: it is closed"));
  while (count > 0) {
    const ssize_t written = write(descriptor_, bytes, count);
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return SystemError(name_, "can't be written", errno);
    bytes += written, count -= written;
  }
  return absl::OkStatus();
}

absl::Status BufferedFile::ReadAt(uint64_t offset, void* bytes, size_t count) const {
  char* to = static_cast<char*>(bytes);
  while (count > 0) {
    const ssize_t got = pread(descriptor_, to, count, static_cast<off_t>(offset));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) return SystemError(name_, "can't be read back", errno);
    if (got == 0) return absl::InternalError(absl::StrCat(name_, " can't be read back: it ends at byte ", offset));
    to += got, count -= got, offset += got;
  }
  return absl::OkStatus();
}

absl::Status BufferedFile::Close() {
  MESHFRONT_RETURN_IF_ERROR(Flush());
  const int descriptor = descriptor_;
  descriptor_ = -1;
  // Without this a power cut soon after the rename could leave an empty file. EINVAL: a pipe or a device.
  if (fsync(descriptor) != 0 && errno != EINVAL && errno != ENOTSUP && errno != EROFS) {
    const int error = errno;
    if (descriptor > STDERR_FILENO) close(descriptor);
    return SystemError(name_, "can't be written", error);
  }
  if (descriptor > STDERR_FILENO && close(descriptor) != 0) return SystemError(name_, "can't be written", errno);
  return absl::OkStatus();
}

absl::StatusOr<std::unique_ptr<BufferedFile>> CreateSpoolFile(const std::string& folder) {
  std::string path;
  MESHFRONT_ASSIGN_OR_RETURN(const int descriptor, CreateTemporary(absl::StrCat(folder, "/.meshfront-spool"),
                                                                   absl::StrCat("the folder ", folder), &path));
  unlink(path.c_str());
  return std::make_unique<BufferedFile>(descriptor, absl::StrCat("the spool file in ", folder));
}

std::string SpoolFolderFor(const std::string& path) {
  struct stat existing;
  const bool special = path == "-" || (stat(path.c_str(), &existing) == 0 && !S_ISREG(existing.st_mode));
  const char* temporary = std::getenv("TMPDIR");
  if (special) return temporary != nullptr && *temporary != '\0' ? temporary : "/tmp";
  const size_t slash = path.rfind('/');
  if (slash == std::string::npos) return ".";
  return slash == 0 ? "/" : path.substr(0, slash);
}

// Compresses what is appended into another sink, with buffers of fixed size.
class OutputFile::GzipSink : public ByteSink {
 public:
  explicit GzipSink(ByteSink& next) : next_(next) {
    constexpr int window_bits = 15, gzip_header = 16, memory_level = 8;
    ready_ = deflateInit2(&stream_, Z_DEFAULT_COMPRESSION, Z_DEFLATED, window_bits + gzip_header, memory_level,
                          Z_DEFAULT_STRATEGY) == Z_OK;
  }
  ~GzipSink() override { deflateEnd(&stream_); }

  absl::Status Append(absl::string_view bytes) override { return Compress(bytes, Z_NO_FLUSH); }
  absl::Status Finish() { return Compress({}, Z_FINISH); }
  const std::string& name() const override { return next_.name(); }

 private:
  absl::Status Compress(absl::string_view bytes, int flush) {
    if (!ready_) return absl::InternalError(absl::StrCat(name(), " can't be compressed: out of memory"));
    stream_.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
    stream_.avail_in = static_cast<uInt>(bytes.size());
    do {
      char out[16 << 10];
      stream_.next_out = reinterpret_cast<Bytef*>(out);
      stream_.avail_out = sizeof(out);
      deflate(&stream_, flush);
      MESHFRONT_RETURN_IF_ERROR(next_.Append({out, sizeof(out) - stream_.avail_out}));
    } while (stream_.avail_out == 0);
    return absl::OkStatus();
  }

  ByteSink& next_;
  z_stream stream_{};
  bool ready_ = false;
};

OutputFile::OutputFile(std::string path, std::string temporary, std::unique_ptr<BufferedFile> file)
    : path_(std::move(path)), temporary_(std::move(temporary)), file_(std::move(file)) {
  if (absl::EndsWithIgnoreCase(path_, ".gz")) gzip_ = std::make_unique<GzipSink>(*file_);
}

ByteSink& OutputFile::sink() {
  if (gzip_ != nullptr) return *gzip_;
  return *file_;
}

OutputFile::~OutputFile() {
  if (!temporary_.empty()) unlink(temporary_.c_str());
}

absl::StatusOr<std::unique_ptr<OutputFile>> OutputFile::Create(const std::string& path) {
  struct stat existing;
  const bool exists = path != "-" && stat(path.c_str(), &existing) == 0;
  if (path == "-") {
    auto file = std::make_unique<BufferedFile>(STDOUT_FILENO, "standard output");
    return std::unique_ptr<OutputFile>(new OutputFile(path, "", std::move(file)));
  }
  if (exists && S_ISDIR(existing.st_mode)) return SystemError(path, "can't be written", EISDIR);
  if (exists && !S_ISREG(existing.st_mode)) {  // /dev/null, a pipe: nothing to be renamed over
    const int descriptor = open(path.c_str(), O_WRONLY | O_CLOEXEC);
    if (descriptor < 0) return SystemError(path, "can't be written", errno);
    return std::unique_ptr<OutputFile>(new OutputFile(path, "", std::make_unique<BufferedFile>(descriptor, path)));
  }
  const std::string target = FileBehindLinks(path);
  std::string temporary;
  MESHFRONT_ASSIGN_OR_RETURN(const int descriptor, CreateTemporary(target, path, &temporary));
  ApplyUsualPermissions(descriptor);
  return std::unique_ptr<OutputFile>(
      new OutputFile(target, temporary, std::make_unique<BufferedFile>(descriptor, path)));
}

absl::Status OutputFile::Finish() {
  if (is_finished_) return absl::OkStatus();
  if (gzip_ != nullptr) MESHFRONT_RETURN_IF_ERROR(gzip_->Finish());
  is_finished_ = true;
  return file_->Close();
}

absl::Status OutputFile::Commit() {
  MESHFRONT_RETURN_IF_ERROR(Finish());
  if (temporary_.empty()) return absl::OkStatus();
  if (rename(temporary_.c_str(), path_.c_str()) != 0) return SystemError(path_, "can't be written", errno);
  temporary_.clear();
  return absl::OkStatus();
}

absl::Status WriteWholeFile(const std::string& path, absl::string_view bytes) {
  MESHFRONT_ASSIGN_OR_RETURN(const std::unique_ptr<OutputFile> output, OutputFile::Create(path));
  MESHFRONT_RETURN_IF_ERROR(output->sink().Append(bytes));
  return output->Commit();
}

absl::Status CheckNoneCollide(const std::vector<NamedOutput>& outputs) {
  std::map<std::string, const NamedOutput*> seen;
  for (const NamedOutput& output : outputs) {
    struct stat existing;
    const bool special = output.path != "-" && stat(output.path.c_str(), &existing) == 0 && !S_ISREG(existing.st_mode);
    if (output.path.empty() || special) continue;
    const std::string file = output.path == "-" ? "-" : FileBehindLinks(output.path);
    const auto [first, is_new] = seen.emplace(file, &output);
    if (is_new) continue;
    return absl::InvalidArgumentError(absl::StrCat(first->second->name, " and ", output.name, " are both ",
                                                   file == "-" ? "standard output" : output.path,
                                                   "; each needs a file of its own"));
  }
  return absl::OkStatus();
}

absl::Status CheckCanBeCreated(const std::string& path) { return OutputFile::Create(path).status(); }

}  // namespace meshfront
