; What compiled PTX programs call: rays through Embree, and the loop over launch indices.
; Frames, launches and records: places as in optix7.py and records.py.

declare void @rtcIntersect1(ptr, ptr, ptr)
declare void @llvm.x86.sse.ldmxcsr(ptr)
declare void @llvm.x86.sse.stmxcsr(ptr)
declare void @llvm.memcpy.p0.p0.i64(ptr, ptr, i64, i1)

@nau.sampler = global ptr null

define internal ptr @at(ptr %base, i64 %offset) alwaysinline {
  %p = getelementptr i8, ptr %base, i64 %offset
  ret ptr %p
}

define internal void @put32(ptr %base, i64 %offset, i32 %value) alwaysinline {
  %p = getelementptr i8, ptr %base, i64 %offset
  store i32 %value, ptr %p
  ret void
}

define internal void @putf(ptr %base, i64 %offset, float %value) alwaysinline {
  %p = getelementptr i8, ptr %base, i64 %offset
  store float %value, ptr %p
  ret void
}

define internal i32 @get32(ptr %base, i64 %offset) alwaysinline {
  %p = getelementptr i8, ptr %base, i64 %offset
  %v = load i32, ptr %p
  ret i32 %v
}

define internal float @getf(ptr %base, i64 %offset) alwaysinline {
  %p = getelementptr i8, ptr %base, i64 %offset
  %v = load float, ptr %p
  ret float %v
}

define internal ptr @getp(ptr %base, i64 %offset) alwaysinline {
  %p = getelementptr i8, ptr %base, i64 %offset
  %v = load ptr, ptr %p
  ret ptr %v
}

define void @nau.texture(i64 %handle, i32 %dimensions, float %x, float %y, float %z, ptr %out) nounwind {
  %sampler = load ptr, ptr @nau.sampler
  %none = icmp eq ptr %sampler, null
  br i1 %none, label %blank, label %ask
blank:
  store <4 x float> zeroinitializer, ptr %out, align 4
  ret void
ask:
  call void %sampler(i64 %handle, i32 %dimensions, float %x, float %y, float %z, ptr %out)
  ret void
}

; The hit that Embree offers, as a frame of an any-hit program. %q: the query of @nau.trace:
; 0 flags, 8 context, 16 filter, 24, 32; then the context: 40 instance, 48 caller's frame,
; 56 payload, 64 SBT offset, 68 stride, 72 flags, 76 ended.
define void @nau.filter(ptr %args) nounwind {
  %valid = call ptr @getp(ptr %args, i64 0)
  %context = call ptr @getp(ptr %args, i64 16)
  %ray = call ptr @getp(ptr %args, i64 24)
  %hit = call ptr @getp(ptr %args, i64 32)
  %is = load i32, ptr %valid
  %off = icmp eq i32 %is, 0
  br i1 %off, label %done, label %look
look:
  %ended = call i32 @get32(ptr %context, i64 36)
  %over = icmp ne i32 %ended, 0
  br i1 %over, label %refuse, label %cull
cull:
  %flags = call i32 @get32(ptr %context, i64 32)
  %nx = call float @getf(ptr %hit, i64 0)
  %ny = call float @getf(ptr %hit, i64 4)
  %nz = call float @getf(ptr %hit, i64 8)
  %dx = call float @getf(ptr %ray, i64 16)
  %dy = call float @getf(ptr %ray, i64 20)
  %dz = call float @getf(ptr %ray, i64 24)
  %a = fmul float %nx, %dx
  %b = fmul float %ny, %dy
  %c = fmul float %nz, %dz
  %ab = fadd float %a, %b
  %dot = fadd float %ab, %c
  %back = fcmp ogt float %dot, 0.0
  %cullb = and i32 %flags, 16
  %cullf = and i32 %flags, 32
  %wantb = icmp ne i32 %cullb, 0
  %wantf = icmp ne i32 %cullf, 0
  %front = xor i1 %back, true
  %lostb = and i1 %wantb, %back
  %lostf = and i1 %wantf, %front
  %lost = or i1 %lostb, %lostf
  br i1 %lost, label %refuse, label %near
near:
  %t = call float @getf(ptr %ray, i64 32)
  %tmin = call float @getf(ptr %ray, i64 12)
  %early = fcmp ole float %t, %tmin
  br i1 %early, label %refuse, label %ask
ask:
  %noany = and i32 %flags, 1
  %skip = icmp ne i32 %noany, 0
  br i1 %skip, label %accept, label %find
find:
  %caller = call ptr @getp(ptr %context, i64 8)
  %launch = call ptr @getp(ptr %caller, i64 0)
  %geometry = call i32 @get32(ptr %hit, i64 24)
  %stride = call i32 @get32(ptr %context, i64 28)
  %offset = call i32 @get32(ptr %context, i64 24)
  %g = mul i32 %geometry, %stride
  %r = add i32 %g, %offset
  %count = call i32 @get32(ptr %launch, i64 40)
  %known = icmp ult i32 %r, %count
  br i1 %known, label %take, label %accept
take:
  %records = call ptr @getp(ptr %launch, i64 8)
  %r64 = zext i32 %r to i64
  %byte = mul i64 %r64, 128
  %record = getelementptr i8, ptr %records, i64 %byte
  %program = call ptr @getp(ptr %record, i64 8)
  %none = icmp eq ptr %program, null
  br i1 %none, label %accept, label %run
run:
  %frame = alloca [112 x i8], align 16
  call void @llvm.memcpy.p0.p0.i64(ptr %frame, ptr %caller, i64 112, i1 false)
  %payload = call ptr @getp(ptr %context, i64 16)
  %slot = getelementptr i8, ptr %frame, i64 8
  store ptr %payload, ptr %slot
  %data = getelementptr i8, ptr %record, i64 16
  %dslot = getelementptr i8, ptr %frame, i64 16
  store ptr %data, ptr %dslot
  %prim = call i32 @get32(ptr %hit, i64 20)
  call void @put32(ptr %frame, i64 24, i32 %prim)
  %u = call float @getf(ptr %hit, i64 12)
  %v = call float @getf(ptr %hit, i64 16)
  call void @putf(ptr %frame, i64 28, float %u)
  call void @putf(ptr %frame, i64 32, float %v)
  %ox = call float @getf(ptr %ray, i64 0)
  %oy = call float @getf(ptr %ray, i64 4)
  %oz = call float @getf(ptr %ray, i64 8)
  call void @putf(ptr %frame, i64 36, float %ox)
  call void @putf(ptr %frame, i64 40, float %oy)
  call void @putf(ptr %frame, i64 44, float %oz)
  call void @putf(ptr %frame, i64 48, float %dx)
  call void @putf(ptr %frame, i64 52, float %dy)
  call void @putf(ptr %frame, i64 56, float %dz)
  call void @putf(ptr %frame, i64 60, float %tmin)
  call void @putf(ptr %frame, i64 64, float %t)
  call void @put32(ptr %frame, i64 72, i32 %flags)
  %kind = select i1 %back, i32 255, i32 254
  call void @put32(ptr %frame, i64 80, i32 %kind)
  call void @put32(ptr %frame, i64 88, i32 0)
  call void @put32(ptr %frame, i64 104, i32 %geometry)
  call void %program(ptr %frame)
  %status = call i32 @get32(ptr %frame, i64 88)
  %ignored = and i32 %status, 1
  %drop = icmp ne i32 %ignored, 0
  br i1 %drop, label %refuse, label %kept
kept:
  %stop = and i32 %status, 2
  %stops = icmp ne i32 %stop, 0
  br i1 %stops, label %end, label %accept
end:
  call void @put32(ptr %context, i64 36, i32 1)
  ret void
accept:
  %first = and i32 %flags, 4
  %only = icmp ne i32 %first, 0
  br i1 %only, label %end, label %done
refuse:
  store i32 0, ptr %valid
  ret void
done:
  ret void
}

define void @nau.trace(ptr %caller, i64 %handle, float %ox, float %oy, float %oz, float %dx, float %dy, float %dz, float %tmin, float %tmax, float %time, i32 %mask, i32 %flags, i32 %offset, i32 %stride, i32 %miss, ptr %payload) nounwind {
entry:
  %rh = alloca [96 x i8], align 16
  %q = alloca [96 x i8], align 16
  %frame = alloca [112 x i8], align 16
  %launch = call ptr @getp(ptr %caller, i64 0)
  %depth = call i32 @get32(ptr %caller, i64 84)
  %next = add i32 %depth, 1
  %most = call i32 @get32(ptr %launch, i64 36)
  %deep = icmp ugt i32 %next, %most
  br i1 %deep, label %done, label %count
count:
  %rays = call ptr @getp(ptr %launch, i64 48)
  %kind0 = icmp ult i32 %offset, 16
  %kind1 = select i1 %kind0, i32 %offset, i32 15
  %kind2 = zext i32 %kind1 to i64
  %slot = getelementptr i64, ptr %rays, i64 %kind2
  %before = load i64, ptr %slot
  %after = add i64 %before, 1
  store i64 %after, ptr %slot
  call void @llvm.memcpy.p0.p0.i64(ptr %frame, ptr %caller, i64 112, i1 false)
  %pslot = getelementptr i8, ptr %frame, i64 8
  store ptr %payload, ptr %pslot
  call void @putf(ptr %frame, i64 36, float %ox)
  call void @putf(ptr %frame, i64 40, float %oy)
  call void @putf(ptr %frame, i64 44, float %oz)
  call void @putf(ptr %frame, i64 48, float %dx)
  call void @putf(ptr %frame, i64 52, float %dy)
  call void @putf(ptr %frame, i64 56, float %dz)
  call void @putf(ptr %frame, i64 60, float %tmin)
  call void @putf(ptr %frame, i64 64, float %tmax)
  call void @putf(ptr %frame, i64 68, float %time)
  call void @put32(ptr %frame, i64 72, i32 %flags)
  call void @put32(ptr %frame, i64 76, i32 %mask)
  call void @put32(ptr %frame, i64 84, i32 %next)
  %s1 = fsub float %tmax, %tmax
  %s2 = fadd float %ox, %oy
  %s3 = fadd float %oz, %dx
  %s4 = fadd float %dy, %dz
  %s5 = fadd float %s2, %s3
  %s6 = fadd float %s5, %s4
  %s7 = fsub float %s6, %s6
  %finite = fcmp oeq float %s7, 0.0
  %ordered = fcmp olt float %tmin, %tmax
  %scene = call ptr @getp(ptr %launch, i64 0)
  %isscene = icmp ne i64 %handle, 0
  %ok1 = and i1 %finite, %ordered
  %seen = and i32 %mask, 255
  %visible = icmp ne i32 %seen, 0
  %ok2 = and i1 %ok1, %visible
  %ok = and i1 %ok2, %isscene
  br i1 %ok, label %ask, label %missed
ask:
  call void @putf(ptr %rh, i64 0, float %ox)
  call void @putf(ptr %rh, i64 4, float %oy)
  call void @putf(ptr %rh, i64 8, float %oz)
  call void @putf(ptr %rh, i64 12, float %tmin)
  call void @putf(ptr %rh, i64 16, float %dx)
  call void @putf(ptr %rh, i64 20, float %dy)
  call void @putf(ptr %rh, i64 24, float %dz)
  call void @putf(ptr %rh, i64 28, float 0.0)
  call void @putf(ptr %rh, i64 32, float %tmax)
  call void @put32(ptr %rh, i64 36, i32 -1)
  call void @put32(ptr %rh, i64 40, i32 0)
  call void @put32(ptr %rh, i64 44, i32 0)
  call void @put32(ptr %rh, i64 72, i32 -1)
  call void @put32(ptr %rh, i64 76, i32 -1)
  call void @put32(ptr %rh, i64 80, i32 -1)
  call void @put32(ptr %q, i64 0, i32 2)
  call void @put32(ptr %q, i64 4, i32 -1)
  %context = getelementptr i8, ptr %q, i64 40
  %qc = getelementptr i8, ptr %q, i64 8
  store ptr %context, ptr %qc
  %qf = getelementptr i8, ptr %q, i64 16
  store ptr @nau.filter, ptr %qf
  %qi = getelementptr i8, ptr %q, i64 24
  store ptr null, ptr %qi
  %qw = getelementptr i8, ptr %q, i64 32
  store i64 0, ptr %qw
  call void @put32(ptr %context, i64 0, i32 -1)
  call void @put32(ptr %context, i64 4, i32 -1)
  %cc = getelementptr i8, ptr %context, i64 8
  store ptr %frame, ptr %cc
  %cp = getelementptr i8, ptr %context, i64 16
  store ptr %payload, ptr %cp
  call void @put32(ptr %context, i64 24, i32 %offset)
  call void @put32(ptr %context, i64 28, i32 %stride)
  call void @put32(ptr %context, i64 32, i32 %flags)
  call void @put32(ptr %context, i64 36, i32 0)
  call void @rtcIntersect1(ptr %scene, ptr %rh, ptr %q)
  %geometry = call i32 @get32(ptr %rh, i64 72)
  %hit = icmp ne i32 %geometry, -1
  br i1 %hit, label %found, label %missed
found:
  %noclosest = and i32 %flags, 8
  %skip = icmp ne i32 %noclosest, 0
  br i1 %skip, label %done, label %shade
shade:
  %g = mul i32 %geometry, %stride
  %r = add i32 %g, %offset
  %count2 = call i32 @get32(ptr %launch, i64 40)
  %known = icmp ult i32 %r, %count2
  br i1 %known, label %take, label %done
take:
  %records = call ptr @getp(ptr %launch, i64 8)
  %r64 = zext i32 %r to i64
  %byte = mul i64 %r64, 128
  %record = getelementptr i8, ptr %records, i64 %byte
  %program = call ptr @getp(ptr %record, i64 0)
  %none = icmp eq ptr %program, null
  br i1 %none, label %done, label %run
run:
  %data = getelementptr i8, ptr %record, i64 16
  %dslot = getelementptr i8, ptr %frame, i64 16
  store ptr %data, ptr %dslot
  %prim = call i32 @get32(ptr %rh, i64 68)
  %u = call float @getf(ptr %rh, i64 60)
  %v = call float @getf(ptr %rh, i64 64)
  %t = call float @getf(ptr %rh, i64 32)
  call void @put32(ptr %frame, i64 24, i32 %prim)
  call void @putf(ptr %frame, i64 28, float %u)
  call void @putf(ptr %frame, i64 32, float %v)
  call void @putf(ptr %frame, i64 64, float %t)
  %nx = call float @getf(ptr %rh, i64 48)
  %ny = call float @getf(ptr %rh, i64 52)
  %nz = call float @getf(ptr %rh, i64 56)
  %a = fmul float %nx, %dx
  %b = fmul float %ny, %dy
  %c = fmul float %nz, %dz
  %ab = fadd float %a, %b
  %dot = fadd float %ab, %c
  %back = fcmp ogt float %dot, 0.0
  %kind = select i1 %back, i32 255, i32 254
  call void @put32(ptr %frame, i64 80, i32 %kind)
  call void @put32(ptr %frame, i64 104, i32 %geometry)
  call void %program(ptr %frame)
  br label %done
missed:
  %mcount = call i32 @get32(ptr %launch, i64 44)
  %mknown = icmp ult i32 %miss, %mcount
  br i1 %mknown, label %mtake, label %done
mtake:
  %mrecords = call ptr @getp(ptr %launch, i64 16)
  %m64 = zext i32 %miss to i64
  %mbyte = mul i64 %m64, 128
  %mrecord = getelementptr i8, ptr %mrecords, i64 %mbyte
  %mprogram = call ptr @getp(ptr %mrecord, i64 0)
  %mnone = icmp eq ptr %mprogram, null
  br i1 %mnone, label %done, label %mrun
mrun:
  %mdata = getelementptr i8, ptr %mrecord, i64 16
  %mslot = getelementptr i8, ptr %frame, i64 16
  store ptr %mdata, ptr %mslot
  call void %mprogram(ptr %frame)
  br label %done
done:
  ret void
}

; Launch indices begin to end of a launch, by the ray generation program. Denormals are zero while
; it runs where the launch says so (SSE: flush to zero, denormals are zero).
define void @nau.launch(ptr %program, ptr %launch, i64 %begin, i64 %end) nounwind {
entry:
  %frame = alloca [112 x i8], align 16
  %old = alloca i32
  %now = alloca i32
  call void @llvm.x86.sse.stmxcsr(ptr %old)
  %word = load i32, ptr %old
  %wanted = call i32 @get32(ptr %launch, i64 64)
  %on = icmp ne i32 %wanted, 0
  %bits = select i1 %on, i32 32832, i32 0
  %flush = or i32 %word, %bits
  store i32 %flush, ptr %now
  call void @llvm.x86.sse.ldmxcsr(ptr %now)
  %width = call i32 @get32(ptr %launch, i64 24)
  %height = call i32 @get32(ptr %launch, i64 28)
  %w64 = zext i32 %width to i64
  %h64 = zext i32 %height to i64
  %record = call ptr @getp(ptr %launch, i64 56)
  %mark = call ptr @getp(ptr %launch, i64 72)
  br label %test
test:
  %i = phi i64 [ %begin, %entry ], [ %i1, %body ]
  %more = icmp ult i64 %i, %end
  br i1 %more, label %body, label %done
body:
  store [112 x i8] zeroinitializer, ptr %frame
  store ptr %launch, ptr %frame
  %dslot = getelementptr i8, ptr %frame, i64 16
  store ptr %record, ptr %dslot
  %x = urem i64 %i, %w64
  %rest = udiv i64 %i, %w64
  %y = urem i64 %rest, %h64
  %z = udiv i64 %rest, %h64
  %x32 = trunc i64 %x to i32
  %y32 = trunc i64 %y to i32
  %z32 = trunc i64 %z to i32
  call void @put32(ptr %frame, i64 92, i32 %x32)
  call void @put32(ptr %frame, i64 96, i32 %y32)
  call void @put32(ptr %frame, i64 100, i32 %z32)
  store volatile i64 %i, ptr %mark
  call void %program(ptr %frame)
  %i1 = add i64 %i, 1
  br label %test
done:
  call void @llvm.x86.sse.ldmxcsr(ptr %old)
  ret void
}
