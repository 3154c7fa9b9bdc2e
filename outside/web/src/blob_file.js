// Files of a person's disk for a WASI program: read by pieces, never as a whole.

import { Fd, File, wasi } from "@bjorn3/browser_wasi_shim";

/** Bytes that are read from the disk at once. */
const PIECE = 4 << 20;

/** An open blob; only for reading. */
class OpenBlob extends Fd {
  constructor(file) {
    super();
    this.file = file;
    this.at = 0;
    this.piece = new Uint8Array(0);
    this.from = 0;
  }

  /** At most `size` bytes from an offset; fewer at the end of a piece, none at the end of the file. */
  bytes(size, offset) {
    if (offset < this.from || offset >= this.from + this.piece.length) {
      const blob = this.file.blob.slice(offset, offset + PIECE);
      this.piece = new Uint8Array(new FileReaderSync().readAsArrayBuffer(blob));
      this.from = offset;
    }
    return this.piece.subarray(offset - this.from, offset - this.from + size);
  }

  fd_read(size) {
    const data = this.bytes(size, this.at);
    this.at += data.length;
    return { ret: wasi.ERRNO_SUCCESS, data };
  }

  fd_pread(size, offset) {
    return { ret: wasi.ERRNO_SUCCESS, data: this.bytes(size, Number(offset)) };
  }

  fd_seek(offset, whence) {
    const origins = [0, this.at, this.file.blob.size];
    const at = (origins[whence] ?? NaN) + Number(offset);
    if (!(at >= 0)) return { ret: wasi.ERRNO_INVAL, offset: 0n };
    this.at = at;
    return { ret: wasi.ERRNO_SUCCESS, offset: BigInt(at) };
  }

  fd_tell() {
    return { ret: wasi.ERRNO_SUCCESS, offset: BigInt(this.at) };
  }

  fd_fdstat_get() {
    return { ret: wasi.ERRNO_SUCCESS, fdstat: new wasi.Fdstat(wasi.FILETYPE_REGULAR_FILE, 0) };
  }

  fd_filestat_get() {
    return { ret: wasi.ERRNO_SUCCESS, filestat: this.file.stat() };
  }
}

/** A blob as a file: it stays where it is until a program writes to it. */
export class BlobFile extends File {
  constructor(blob) {
    super(new ArrayBuffer(0));
    this.blob = blob;
  }

  get size() {
    return this.blob ? BigInt(this.blob.size) : BigInt(this.data.byteLength);
  }

  path_open(oflags, rights, flags) {
    const truncates = (oflags & wasi.OFLAGS_TRUNC) === wasi.OFLAGS_TRUNC;
    const writes = (BigInt(rights) & BigInt(wasi.RIGHTS_FD_WRITE)) !== 0n;
    if (this.blob && !truncates && !writes) {
      return { ret: wasi.ERRNO_SUCCESS, fd_obj: new OpenBlob(this) };
    }
    if (this.blob) {
      const kept = truncates ? new ArrayBuffer(0) : new FileReaderSync().readAsArrayBuffer(this.blob);
      this.data = new Uint8Array(kept);
      this.blob = null;
    }
    return super.path_open(oflags, rights, flags);
  }
}
