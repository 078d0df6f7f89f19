;; A Lambert reflector of albedo 0.5, written by hand.
(module
  (import "env" "sin" (func $sin (param f64) (result f64)))
  (import "env" "cos" (func $cos (param f64) (result f64)))
  (memory (export "memory") 1)
  (global $heap (mut i32) (i32.const 1024))
  (data (i32.const 16) "{\"models\":[{\"name\":\"lambert\",\"dimensions\":2}]}\00")
  (data (i32.const 128) "{\"claims\":{\"isotropic\":true}}\00")
  (data (i32.const 192) "there is no such model; there is lambert\00")

  (func (export "gonio_describe") (param $handle i32) (result i32)
    (select (i32.const 128) (i32.const 16) (local.get $handle)))

  ;; Its first four letters are enough.
  (func (export "gonio_create") (param $model i32) (param $parameters i32) (result i32)
    (i32.eq (i32.load (local.get $model)) (i32.const 0x626d616c)))

  (func (export "gonio_destroy") (param $handle i32))

  (func (export "gonio_error") (result i32) (i32.const 192))

  ;; Memory is given out, and never taken back.
  (func (export "gonio_alloc") (param $size i32) (result i32)
    (local $address i32) (local $lacks i32)
    (local.set $address (global.get $heap))
    (global.set $heap
      (i32.and (i32.add (i32.add (local.get $address) (local.get $size)) (i32.const 7)) (i32.const -8)))
    (local.set $lacks (i32.sub (global.get $heap) (i32.mul (memory.size) (i32.const 65536))))
    (if (i32.gt_s (local.get $lacks) (i32.const 0))
      (then
        (if (i32.eq (memory.grow (i32.div_u (i32.add (local.get $lacks) (i32.const 65535)) (i32.const 65536)))
                    (i32.const -1))
          (then (return (i32.const 0))))))
    (local.get $address))

  (func (export "gonio_free") (param $address i32) (param $size i32))

  ;; Writes a · b of each row, where the row's z and wo's are above the horizon; b is z or 1.
  (func $fill (param $wo i32) (param $n i32) (param $wi i32) (param $out i32) (param $a f64) (param $cosine i32)
    (local $z f64)
    (block $end
      (loop $row
        (br_if $end (i32.eqz (local.get $n)))
        (local.set $z (f64.load offset=16 (local.get $wi)))
        (f64.store (local.get $out)
          (if (result f64)
            (i32.and (f64.gt (local.get $z) (f64.const 0)) (f64.gt (f64.load offset=16 (local.get $wo)) (f64.const 0)))
            (then
              (f64.mul (local.get $a) (select (local.get $z) (f64.const 1) (local.get $cosine))))
            (else (f64.const 0))))
        (local.set $wi (i32.add (local.get $wi) (i32.const 24)))
        (local.set $out (i32.add (local.get $out) (i32.const 8)))
        (local.set $n (i32.sub (local.get $n) (i32.const 1)))
        (br $row))))

  (func (export "gonio_eval")
    (param $handle i32) (param $mode i32) (param $wo i32) (param $n i32) (param $wi i32) (param $f i32) (result i32)
    (call $fill (local.get $wo) (local.get $n) (local.get $wi) (local.get $f)
      (f64.const 0.15915494309189535) (i32.const 0))
    (i32.const 0))

  (func (export "gonio_pdf")
    (param $handle i32) (param $mode i32) (param $wo i32) (param $n i32) (param $wi i32) (param $p i32) (result i32)
    (call $fill (local.get $wo) (local.get $n) (local.get $wi) (local.get $p)
      (f64.const 0.3183098861837907) (i32.const 1))
    (i32.const 0))

  (func (export "gonio_sample")
    (param $handle i32) (param $mode i32) (param $wo i32) (param $n i32) (param $u i32)
    (param $wi i32) (param $weight i32) (param $pdf i32) (param $flags i32) (result i32)
    (local $r f64) (local $phi f64) (local $z f64)
    (block $end
      (loop $row
        (br_if $end (i32.eqz (local.get $n)))
        (local.set $r (f64.sqrt (f64.load (local.get $u))))
        (local.set $phi (f64.mul (f64.const 6.283185307179586) (f64.load offset=8 (local.get $u))))
        (local.set $z (f64.sqrt (f64.sub (f64.const 1) (f64.load (local.get $u)))))
        (f64.store (local.get $wi) (f64.mul (local.get $r) (call $cos (local.get $phi))))
        (f64.store offset=8 (local.get $wi) (f64.mul (local.get $r) (call $sin (local.get $phi))))
        (f64.store offset=16 (local.get $wi) (local.get $z))
        (f64.store (local.get $weight) (f64.const 0.5))
        (f64.store (local.get $pdf) (f64.mul (local.get $z) (f64.const 0.3183098861837907)))
        (f64.store (local.get $flags) (f64.const 5))
        (local.set $u (i32.add (local.get $u) (i32.const 16)))
        (local.set $wi (i32.add (local.get $wi) (i32.const 24)))
        (local.set $weight (i32.add (local.get $weight) (i32.const 8)))
        (local.set $pdf (i32.add (local.get $pdf) (i32.const 8)))
        (local.set $flags (i32.add (local.get $flags) (i32.const 8)))
        (local.set $n (i32.sub (local.get $n) (i32.const 1)))
        (br $row)))
    (i32.const 0)))
