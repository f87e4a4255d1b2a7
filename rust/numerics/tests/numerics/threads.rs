//! Jobs and rows of a batch shared between threads, and the threads that stay for the next one.

use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::thread;

use six_wheel_numerics::error::Error;
use six_wheel_numerics::threads::workers::Workers;

#[test]
fn every_row_gets_its_own_numbers_and_the_first_that_fails_is_told() {
    for count in [0, 1, 5, 30_001] {
        for threads in [1, 2, 3] {
            let (mut pairs, mut ones, mut none) = (vec![0.0; 2 * count], vec![0.0; count], []);
            let outputs: [(&mut [f64], usize); 3] = [(&mut pairs, 2), (&mut ones, 1), (&mut none, 0)];
            let workers = Workers { threads, ..Workers::PLAIN };
            let result = workers.rows(count, outputs, |row, [pair, one, none]| {
                pair.fill(row as f64);
                one[0] += 1.0;
                match row {
                    3 | 29_000 => Err(Error::value("row", "work", row)),
                    _ if none.is_empty() => Ok(()),
                    _ => Err(Error::value("width", "be 0", none.len())),
                }
            });
            let told = result.err().map(|error| error.value);
            assert_eq!(told, (count > 3).then(|| "3".to_owned()));
            let places = || pairs.chunks(2).enumerate();
            assert!(places().all(|(k, pair)| pair == [k as f64; 2] || ones[k] == 0.0));
        }
    }
}

#[test]
fn an_interruption_ends_the_call_with_any_number_of_threads() {
    // The other threads wait in their first share until the caller was asked: fast ones took every share before it.
    static ASKED: AtomicBool = AtomicBool::new(false);
    let caller = thread::current().id();
    for threads in [1, 2, 3] {
        ASKED.store(false, Ordering::Relaxed);
        let is_interrupted = || {
            ASKED.store(true, Ordering::Relaxed);
            true
        };
        let workers = Workers { threads, is_interrupted, ..Workers::PLAIN };
        let mut values = vec![0.0; 100_000];
        let ended = workers.rows(values.len(), [(&mut values, 1)], |_, [value]| {
            while thread::current().id() != caller && !ASKED.load(Ordering::Relaxed) {
                thread::yield_now();
            }
            value.fill(1.0);
            Ok(())
        });
        assert_eq!(ended, Err(Error::interrupted()));
        assert!(values.contains(&0.0));
    }
}

#[test]
fn an_interruption_ends_long_jobs_of_all_threads() {
    static ASKED: AtomicBool = AtomicBool::new(false);
    for threads in [1, 2, 3] {
        ASKED.store(false, Ordering::Relaxed);
        let is_interrupted = || ASKED.load(Ordering::Relaxed);
        let workers = Workers { threads, is_interrupted, ..Workers::PLAIN };
        let ended = workers.for_each_long(0..3, |_, interruption| {
            ASKED.store(true, Ordering::Relaxed);
            loop {
                interruption.check()?;
            }
        });
        assert_eq!(ended, Err(Error::interrupted()));
    }
}

#[test]
fn every_job_is_done_once_and_the_first_failure_is_told() {
    for count in [0, 1, 2, 7, 1000] {
        let mut done = vec![0; count];
        let workers = Workers { threads: 3, ..Workers::PLAIN };
        let result = workers.for_each(done.iter_mut().enumerate(), |(number, times)| {
            *times += 1;
            match number {
                5 | 900 => Err(Error::value("job", "work", number)),
                _ => Ok(()),
            }
        });
        assert!(done.iter().all(|times| *times == 1));
        assert_eq!(result.err().map(|error| error.value), (count > 5).then(|| "5".to_owned()));
    }
}

/// Counts to 1000 by whoever is there.
fn count(threads: usize) -> usize {
    let done = AtomicUsize::new(0);
    let workers = Workers { threads, ..Workers::PLAIN };
    let counted = workers.for_each(0..1000, |_| {
        done.fetch_add(1, Ordering::Relaxed);
        Ok(())
    });
    assert_eq!(counted, Ok(()));
    done.into_inner()
}

#[test]
fn all_is_done_on_return_however_many_there_are() {
    for threads in [1, 2, 4, 8, 3] {
        for _ in 0..200 {
            assert_eq!(count(threads), 1000);
        }
    }
}

#[test]
fn several_callers_and_callers_within_a_task_all_get_their_work_done() -> Result<(), Error> {
    thread::scope(|scope| {
        for _ in 0..8 {
            scope.spawn(|| (0..100).for_each(|_| assert_eq!(count(4), 1000)));
        }
    });
    let inner = AtomicUsize::new(0);
    let workers = Workers { threads: 3, ..Workers::PLAIN };
    workers.for_each(0..3, |_| {
        inner.fetch_add(count(3), Ordering::Relaxed);
        Ok(())
    })?;
    assert_eq!(inner.into_inner(), 3000);
    Ok(())
}

#[test]
fn a_panic_reaches_the_caller_and_the_pool_goes_on() {
    for _ in 0..20 {
        let (caller, there) = (thread::current().id(), AtomicUsize::new(0));
        let workers = Workers { threads: 2, ..Workers::PLAIN };
        let panicked = catch_unwind(AssertUnwindSafe(|| {
            workers.for_each(0..1000, |_| {
                if thread::current().id() != caller {
                    there.fetch_add(1, Ordering::Relaxed);
                    resume_unwind(Box::new("a helper's"));
                }
                Ok(())
            })
        }));
        assert_eq!(panicked.is_err(), there.into_inner() > 0);
        assert_eq!(count(3), 1000);
    }
}
